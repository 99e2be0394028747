#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace vultus::virtual_stage {

/// Muscle-like actions of one side of the face, with the FACS action unit each resembles.
enum class Muscle {
  frontalis_inner,      ///< AU1
  frontalis_outer,      ///< AU2
  brow_lowerer,         ///< AU4, procerus and depressor supercilii
  corrugator,           ///< AU4, brows together
  lid_raiser,           ///< AU5
  cheek_raiser,         ///< AU6, orbicularis oculi, orbital part
  lid_tightener,        ///< AU7
  lid_closer,           ///< AU43/45
  nose_wrinkler,        ///< AU9
  nostril_flare,        ///< AU38
  upper_lip_raiser,     ///< AU10, levator labii
  zygomaticus,          ///< AU12
  dimpler,              ///< AU14, buccinator
  anguli_depressor,     ///< AU15
  lower_lip_depressor,  ///< AU16, depressor labii
  chin_raiser,          ///< AU17, mentalis
  risorius,             ///< AU20
  pucker,               ///< AU18
  funnel,               ///< AU22
  lip_press,            ///< AU24
  upper_lip_roll,       ///< AU28, upper
  lower_lip_roll,       ///< AU28, lower
  lips_part,            ///< AU25 without the jaw
  cheek_puff,           ///< AU34
  count
};
constexpr int muscle_count = static_cast<int>(Muscle::count);

enum class Side { left, right };  ///< the subject's
/// What the jaw can do; each moves both sides.
enum class Jaw { open, left, forward, count };

/// Strength of every channel: each muscle left and right, then the jaw. 0 is rest and 1 as far as most people go;
/// between, and a little beyond, effects are proportional (lids and jaw: in angle). Negative `Jaw::left` is right.
using Activations = Eigen::VectorXd;
constexpr int channel_count = 2 * muscle_count + static_cast<int>(Jaw::count);

constexpr int channel(Muscle muscle, Side side) { return 2 * static_cast<int>(muscle) + static_cast<int>(side); }
constexpr int channel(Jaw jaw) { return 2 * muscle_count + static_cast<int>(jaw); }
/// "zygomaticus_left", "jaw_open", … in channel order.
const std::vector<std::string>& channel_names();

inline Activations at_rest() { return Activations::Zero(channel_count); }
/// Sets both sides of a muscle.
inline void set_both(Activations& activations, Muscle muscle, double strength) {
  activations[channel(muscle, Side::left)] = strength;
  activations[channel(muscle, Side::right)] = strength;
}
/// The same action as seen in a mirror.
Activations mirrored(const Activations& activations);

}  // namespace vultus::virtual_stage
