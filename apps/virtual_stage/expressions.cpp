#include "apps/virtual_stage/expressions.h"

#include <initializer_list>
#include <utility>

#include "core/error.h"
#include "core/files.h"

namespace vultus::virtual_stage {
namespace {

using enum Muscle;
using Muscles = std::initializer_list<std::pair<Muscle, double>>;

Expression make(std::string name, std::vector<std::string> tags, const Muscles& muscles, double jaw_open = 0.0,
                double jaw_forward = 0.0) {
  Expression e{std::move(name), std::move(tags), at_rest()};
  for (const auto& [muscle, strength] : muscles) set_both(e.activations, muscle, strength);
  e.activations[channel(Jaw::open)] = jaw_open;
  e.activations[channel(Jaw::forward)] = jaw_forward;
  return e;
}

void add_upper_face(std::vector<Expression>& all) {
  all.push_back(make("brows_up", {"AU1", "AU2", "AU5", "browInnerUp", "browOuterUp"},
                     {{frontalis_inner, 0.95}, {frontalis_outer, 1.0}, {lid_raiser, 0.35}}));
  all.push_back(
      make("brows_down", {"AU4", "AU7", "browDown"}, {{brow_lowerer, 0.9}, {corrugator, 1.0}, {lid_tightener, 0.35}}));
  all.push_back(make("brows_sad", {"AU1", "AU4", "browInnerUp"},
                     {{frontalis_inner, 1.0}, {corrugator, 0.75}, {anguli_depressor, 0.2}}));
  all.push_back(make("eyes_closed", {"AU43", "eyeBlink"}, {{lid_closer, 1.0}}));
  all.push_back(
      make("eyes_wide", {"AU5", "eyeWide"}, {{lid_raiser, 1.0}, {frontalis_inner, 0.2}, {frontalis_outer, 0.3}}));
  all.push_back(make("squint", {"AU6", "AU7", "eyeSquint", "cheekSquint"},
                     {{lid_tightener, 0.9}, {cheek_raiser, 0.9}, {brow_lowerer, 0.25}, {upper_lip_raiser, 0.15}}));
}

void add_lower_face(std::vector<Expression>& all) {
  all.push_back(make("nose_wrinkle", {"AU9", "AU10", "noseSneer", "mouthUpperUp"},
                     {{nose_wrinkler, 1.0},
                      {upper_lip_raiser, 0.45},
                      {brow_lowerer, 0.4},
                      {lid_tightener, 0.5},
                      {cheek_raiser, 0.35},
                      {nostril_flare, 0.5}}));
  all.push_back(make("smile_closed", {"AU6", "AU12", "mouthSmile"},
                     {{zygomaticus, 0.85}, {cheek_raiser, 0.45}, {lid_tightener, 0.15}}));
  all.push_back(make("smile_teeth", {"AU6", "AU12", "AU25", "mouthSmile"},
                     {{zygomaticus, 1.0},
                      {cheek_raiser, 0.75},
                      {upper_lip_raiser, 0.6},
                      {lips_part, 0.6},
                      {lower_lip_depressor, 0.08},
                      {lid_tightener, 0.25}},
                     0.06));
  all.push_back(make("frown", {"AU15", "AU17", "mouthFrown"},
                     {{anguli_depressor, 1.0}, {chin_raiser, 0.55}, {corrugator, 0.3}, {brow_lowerer, 0.15}}));
  all.push_back(make(
      "lip_stretch", {"AU20", "AU25", "mouthStretch"},
      {{risorius, 1.0}, {lips_part, 0.8}, {lower_lip_depressor, 0.45}, {anguli_depressor, 0.2}, {frontalis_inner, 0.3}},
      0.05));
  all.push_back(make("snarl", {"AU10", "AU16", "AU25", "mouthUpperUp", "mouthLowerDown"},
                     {{upper_lip_raiser, 1.0},
                      {lower_lip_depressor, 0.9},
                      {nose_wrinkler, 0.4},
                      {lips_part, 0.5},
                      {brow_lowerer, 0.35}},
                     0.03));
  all.push_back(make("pucker", {"AU18", "mouthPucker"}, {{pucker, 1.0}}));
  all.push_back(
      make("lips_pressed", {"AU24", "AU17", "mouthPress"}, {{lip_press, 1.0}, {chin_raiser, 0.5}, {dimpler, 0.5}}));
  all.push_back(make("cheeks_puffed", {"AU34", "cheekPuff"}, {{cheek_puff, 1.0}, {lip_press, 0.25}}));
  all.push_back(make("jaw_open", {"AU26", "AU27", "jawOpen"}, {{lips_part, 0.3}, {upper_lip_raiser, 0.12}}, 0.9));
  all.push_back(make("scream", {"AU5", "AU10", "AU16", "AU20", "AU27"},
                     {{upper_lip_raiser, 0.6},
                      {lower_lip_depressor, 0.5},
                      {risorius, 0.55},
                      {frontalis_inner, 0.7},
                      {frontalis_outer, 0.6},
                      {lid_raiser, 0.8}},
                     0.85));
}

void add_visemes(std::vector<Expression>& all) {
  all.push_back(make("viseme_AI", {"viseme_AI", "AU25", "AU26"},
                     {{lips_part, 0.7}, {lower_lip_depressor, 0.3}, {upper_lip_raiser, 0.3}, {risorius, 0.2}}, 0.5));
  all.push_back(make("viseme_O", {"viseme_O", "AU22", "AU26", "mouthFunnel"}, {{funnel, 0.8}, {pucker, 0.38}}, 0.36));
  all.push_back(make(
      "viseme_E", {"viseme_E", "AU20", "AU25"},
      {{risorius, 0.6}, {zygomaticus, 0.2}, {lips_part, 1.0}, {lower_lip_depressor, 0.5}, {upper_lip_raiser, 0.25}},
      0.13));
  all.push_back(make("viseme_FV", {"viseme_FV", "AU28", "mouthRollLower"},
                     {{lower_lip_roll, 0.8}, {chin_raiser, 0.25}, {upper_lip_raiser, 0.4}, {lips_part, 0.3}}, 0.05,
                     -0.1));
}

}  // namespace

const std::vector<Expression>& expression_database() {
  static const std::vector<Expression> database = [] {
    std::vector<Expression> all = {make("neutral", {"neutral"}, {})};
    add_upper_face(all);
    add_lower_face(all);
    add_visemes(all);
    return all;
  }();
  return database;
}

const Expression& expression(const std::string& name) {
  std::vector<std::string> names;
  for (const Expression& e : expression_database()) {
    if (e.name == name) return e;
    names.push_back(e.name);
  }
  throw InputError("no expression \"" + name + "\"; nearest is \"" + nearest_name(name, names) + "\"");
}

}  // namespace vultus::virtual_stage
