#include "apps/virtual_stage/performances.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "apps/virtual_stage/expressions.h"
#include "core/error.h"
#include "core/files.h"
#include "core/random.h"

namespace vultus::virtual_stage {
namespace {

// Something the face does: `amount` of `channels` (both summed into the frame), eased in and out.
struct Gesture {
  double begin, attack, hold, release;  // seconds
  Activations amount;

  double strength(double time) const {
    const auto ease = [](double t) { return t * t * t * (10 - 15 * t + 6 * t * t); };  // least jerk
    const double t = time - begin;
    if (t <= 0 || t >= attack + hold + release) return 0.0;
    if (t < attack) return ease(t / attack);
    if (t <= attack + hold) return 1.0;
    return ease(1.0 - (t - attack - hold) / release);
  }
};

// A pose with its own strength on each side of the face; the jaw takes the mean.
Activations sided(const std::string& pose, double left, double right) {
  Activations a = expression(pose).activations;
  for (int m = 0; m < muscle_count; ++m) {
    a[2 * m] *= left;
    a[2 * m + 1] *= right;
  }
  a.tail(static_cast<int>(Jaw::count)) *= 0.5 * (left + right);
  return a;
}

Activations muscle(Muscle which, double left, double right) {
  Activations a = at_rest();
  a[channel(which, Side::left)] = left;
  a[channel(which, Side::right)] = right;
  return a;
}

Activations jaw(double open, double left, double forward = 0.0) {
  Activations a = at_rest();
  a[channel(Jaw::open)] = open;
  a[channel(Jaw::left)] = left;
  a[channel(Jaw::forward)] = forward;
  return a;
}

using Phrase = std::vector<Gesture>;

void blink(Phrase& phrase, double at) { phrase.push_back({at, 0.09, 0.04, 0.16, sided("eyes_closed", 1, 1)}); }

// Phonemes overlap: each begins to form while the one before still fades (Cohen and Massaro 1993).
Phrase speech() {
  struct Phone {
    double at, length;
    const char* pose;
    double strength;
  };
  constexpr Phone phones[] = {
      {0.35, 0.16, "viseme_AI", 0.7},    {0.52, 0.12, "lips_pressed", 0.6}, {0.66, 0.20, "viseme_O", 0.9},
      {0.88, 0.14, "viseme_E", 0.8},     {1.04, 0.12, "viseme_FV", 0.9},    {1.20, 0.22, "viseme_AI", 0.9},
      {1.50, 0.12, "lips_pressed", 0.7}, {1.64, 0.16, "viseme_E", 0.9},     {1.84, 0.20, "viseme_O", 0.8},
      {2.10, 0.12, "viseme_FV", 0.8},    {2.24, 0.22, "viseme_AI", 1.0},    {2.90, 0.20, "viseme_E", 1.0},
      {3.12, 0.14, "lips_pressed", 0.6}, {3.28, 0.24, "viseme_O", 1.0},     {3.58, 0.20, "viseme_AI", 0.8},
      {3.84, 0.14, "viseme_FV", 0.9},    {4.00, 0.20, "viseme_E", 0.7},     {4.26, 0.22, "pucker", 0.7},
      {4.56, 0.22, "viseme_AI", 0.9},    {5.40, 0.20, "viseme_AI", 0.6},    {5.62, 0.16, "viseme_E", 0.8},
      {5.84, 0.14, "lips_pressed", 0.7}, {6.00, 0.26, "viseme_O", 0.9}};
  Phrase phrase;
  for (const Phone& p : phones)
    phrase.push_back({p.at - 0.09, 0.11, 0.5 * p.length, 0.14, sided(p.pose, p.strength, 0.94 * p.strength)});
  phrase.push_back({1.1, 0.2, 0.35, 0.4, muscle(Muscle::frontalis_outer, 0.1, 0.9)});
  phrase.push_back({2.1, 0.2, 0.5, 0.5, sided("brows_up", 0.6, 0.6)});
  phrase.push_back({3.2, 0.25, 0.6, 0.4, sided("brows_down", 0.7, 0.45)});
  phrase.push_back({5.3, 0.2, 0.5, 0.4, muscle(Muscle::frontalis_inner, 0.7, 0.15)});
  phrase.push_back({6.3, 0.35, 0.8, 0.4, sided("smile_closed", 1.0, 0.25)});
  for (const double at : {0.7, 2.6, 5.0, 6.9}) blink(phrase, at);
  return phrase;
}

Phrase emotions() {
  Phrase phrase = {{0.3, 0.35, 0.6, 0.4, sided("smile_teeth", 0.9, 0.8)},
                   {1.2, 0.30, 0.5, 0.4, sided("smile_closed", 0.15, 1.0)},
                   {1.7, 0.25, 0.5, 0.4, sided("nose_wrinkle", 0.9, 0.2)},
                   {2.5, 0.35, 0.6, 0.4, sided("brows_sad", 0.9, 0.8)},
                   {2.6, 0.40, 0.6, 0.4, sided("frown", 0.9, 0.55)},
                   {3.7, 0.18, 0.5, 0.35, sided("brows_up", 1.0, 1.0)},
                   {3.72, 0.18, 0.45, 0.35, sided("jaw_open", 0.55, 0.55)},
                   {3.7, 0.16, 0.4, 0.3, sided("eyes_wide", 0.9, 0.9)},
                   {4.7, 0.30, 0.6, 0.35, sided("brows_down", 0.9, 1.0)},
                   {4.8, 0.25, 0.5, 0.35, sided("snarl", 0.75, 0.3)},
                   {5.8, 0.25, 0.6, 0.4, muscle(Muscle::dimpler, 1.0, 0.0)},
                   {5.85, 0.25, 0.6, 0.4, muscle(Muscle::frontalis_outer, 0.9, 0.0)},
                   {6.8, 0.25, 0.35, 0.3, sided("smile_closed", 0.7, 0.9)},
                   {6.95, 0.14, 0.18, 0.2, muscle(Muscle::lid_closer, 0.0, 1.0)},
                   {6.92, 0.16, 0.2, 0.2, muscle(Muscle::cheek_raiser, 0.0, 0.8)}};
  for (const double at : {1.0, 2.3, 4.4, 5.6}) blink(phrase, at);
  return phrase;
}

Phrase asymmetry() {
  Phrase phrase = {{0.3, 0.25, 0.4, 0.3, sided("brows_up", 1.0, 0.0)},
                   {1.0, 0.25, 0.4, 0.3, sided("brows_up", 0.0, 1.0)},
                   {1.7, 0.15, 0.25, 0.2, sided("eyes_closed", 1.0, 0.05)},
                   {1.68, 0.18, 0.28, 0.2, sided("squint", 0.7, 0.05)},
                   {2.4, 0.3, 0.4, 0.3, sided("smile_teeth", 0.0, 1.0)},
                   {3.2, 0.3, 0.4, 0.3, sided("lip_stretch", 0.9, 0.0)},
                   {3.2, 0.3, 0.4, 0.3, sided("brows_down", 0.0, 0.9)},
                   {4.0, 0.3, 0.2, 0.3, jaw(0.25, 0.9)},
                   {4.6, 0.3, 0.2, 0.3, jaw(0.3, -0.9)},
                   {5.3, 0.3, 0.4, 0.3, sided("cheeks_puffed", 0.9, 0.1)},
                   {6.1, 0.3, 0.3, 0.3, sided("frown", 0.1, 0.9)},
                   {6.15, 0.3, 0.35, 0.3, sided("nose_wrinkle", 0.8, 0.0)},
                   {6.9, 0.2, 0.4, 0.3, sided("smile_closed", 0.9, 0.1)},
                   {6.95, 0.2, 0.3, 0.3, jaw(0.1, 0.4)}};
  for (const double at : {0.9, 2.2, 3.9, 5.9}) blink(phrase, at);
  return phrase;
}

constexpr double phrase_seconds = 8.0;

Phrase phrase_of(const std::string& name) {
  if (name == "speech") return speech();
  if (name == "emotions") return emotions();
  if (name == "asymmetry") return asymmetry();
  throw InputError("no performance \"" + name + "\"; nearest is \"" + nearest_name(name, performance_names()) + "\"");
}

// Muscles have limits, and the lower ones saturate softly when several gestures ask for the same.
void limit(Activations& a) {
  for (int c = 0; c < 2 * muscle_count; ++c) a[c] = std::clamp(a[c], 0.0, 1.15);
  double& open = a[channel(Jaw::open)];
  open = std::clamp(open, 0.0, 1.0);
}

Performance rendered(const std::string& name, const Phrase& phrase, double seconds, double rate_hz) {
  Performance performance{name, rate_hz, {}};
  const int frames = static_cast<int>(std::lround(seconds * rate_hz));
  for (int f = 0; f < frames; ++f) {
    Activations a = at_rest();
    for (const Gesture& gesture : phrase) {
      const double strength = gesture.strength(f / rate_hz);
      if (strength > 0) a += strength * gesture.amount;
    }
    limit(a);
    performance.frames.push_back(std::move(a));
  }
  return performance;
}

}  // namespace

const std::vector<std::string>& performance_names() {
  static const std::vector<std::string> names = {"speech", "emotions", "asymmetry"};
  return names;
}

Performance perform(const std::string& name, double seconds, double rate_hz, std::uint64_t seed) {
  const Phrase once = phrase_of(name);
  Random random(seed, 31);
  Phrase all;
  for (int round = 0; round * phrase_seconds < seconds; ++round)
    for (Gesture gesture : once) {
      if (round % 2 == 1) gesture.amount = mirrored(gesture.amount);
      gesture.begin += round * phrase_seconds + random.uniform(-0.03, 0.03);
      gesture.amount *= random.uniform(0.92, 1.05);
      all.push_back(gesture);
    }
  return rendered(name, all, seconds, rate_hz);
}

TrainingSession training_session(const std::vector<std::string>& poses, double hold_seconds, double rate_hz,
                                 std::uint64_t seed) {
  constexpr double attack = 0.4, release = 0.4, rest = 0.25;
  Random random(seed, 32);
  TrainingSession session;
  Phrase phrase;
  double time = rest;
  for (const std::string& pose : poses) {
    const double effort = random.uniform(0.92, 1.06), lean = random.uniform(-0.04, 0.04);
    phrase.push_back({time, attack, hold_seconds, release, sided(pose, effort + lean, effort - lean)});
    const double first = time + attack, last = first + hold_seconds;
    session.holds.push_back({pose, static_cast<int>(std::ceil(first * rate_hz)), static_cast<int>(last * rate_hz)});
    time = last + release + rest;
  }
  session.performance = rendered("training", phrase, time, rate_hz);
  const double phase = random.uniform(0, 2 * std::numbers::pi);
  for (std::size_t f = 0; f < session.performance.frames.size(); ++f)
    session.performance.frames[f] *=
        1.0 + 0.015 * std::sin(2 * std::numbers::pi * 0.7 * static_cast<double>(f) / rate_hz + phase);
  return session;
}

}  // namespace vultus::virtual_stage
