// SPDX-License-Identifier: Apache-2.0

#include "law/single_friction.h"

#include <algorithm>
#include <cmath>

#include "law/friction_on_disc.h"

namespace mujoco_impact::law {

namespace {

// Below this restitution nothing is given back.
constexpr double kNoExpansion = 1e-3;

// A part of a step that is rounding.
constexpr double kNothing = 1e-9;

// Ratios of less than this part of μ are within the cone.
constexpr double kWithin = 1 - 1e-9;

// A slip that has stopped, in parts of what is allowed.
constexpr double kStopped = 0.1;

constexpr int kMostTries = 2000;

// Pieces whose impulse is a smaller part of the one that stops the contact are small.
constexpr double kSmall = 0.1;

// Gauss-Legendre on [0, 1], and that of two nodes for small pieces.
constexpr double kNode2[2] = {0.211324865405187, 0.788675134594813};
constexpr double kWeight2[2] = {0.5, 0.5};
constexpr int kNodes = 5;
constexpr double kNode[kNodes] = {0.046910077030668, 0.230765344947158, 0.5, 0.769234655052842,
                                  0.953089922969332};
constexpr double kWeight[kNodes] = {0.118463442528095, 0.239314335249683, 0.284444444444444,
                                    0.239314335249683, 0.118463442528095};

double Dot(Pair x, Pair y) {
  const Pair product = x * y;
  return product[0] + product[1];
}

double Length(Pair x) { return std::sqrt(Dot(x, x)); }

// A piece of the impact, at a constant ratio of friction or nearly so, and what it ends with.
struct Piece {
  double dP, c;
  Pair v;
  StepFriction friction;
};

class SinglePath {
 public:
  SinglePath(const FrictionContact& contact, double tolerance);
  SingleFriction Run();

 private:
  Piece Try(double dP) const;
  double Error(const Piece& piece) const;
  double FractionToEnd(const Piece& piece) const;
  void Accept(const Piece& piece, bool ends);
  void AddTime(const Piece& piece, double after);
  double Force(double energy) const;

  const FrictionContact& contact_;
  const Tangents A_, inverse_;
  const double over_e2_;  // 1/e²; 0: nothing expands
  const double allowed_;  // error of a piece [m/s]
  double c_;
  Pair v_;
  Pair ratio_{};        // at the end of the piece before
  bool stuck_ = false;  // whether that is within the cone
  bool expands_ = false, over_ = false;
  double energy_ = 0;  // stored [J]
  double most_ = 0;    // that ever was
  SingleFriction sum_{};
};

SinglePath::SinglePath(const FrictionContact& contact, double tolerance)
    : contact_(contact),
      A_(Lifted(contact.block.tt)),
      inverse_(Inverse(A_)),
      over_e2_(
          contact.restitution < kNoExpansion ? 0 : 1 / (contact.restitution * contact.restitution)),
      allowed_(tolerance * contact.closing_speed),
      c_(contact.closing_speed),
      v_(At(contact.slip)) {}

Piece SinglePath::Try(double dP) const {
  const Pair push = dP * At(contact_.block.tn);
  Piece piece{dP, 0, {}, {}};
  if (contact_.mu > 0) {
    constexpr double kNone[2] = {0, 0};
    const Pair first = push + Times(A_, dP * ratio_);
    const double first_rate[2] = {first[0], first[1]}, rate[2] = {push[0], push[1]};
    piece.friction = FrictionOfStep({A_, inverse_, contact_.mu * dP, v_, v_ + push, dP * ratio_,
                                     stuck_, first_rate, rate, kNone});
  }
  piece.c = c_ - contact_.W * dP - Dot(At(contact_.block.nt), piece.friction.p);
  piece.v = v_ + push + Times(A_, piece.friction.p);
  return piece;
}

// Of a slip that turns, in units of what is allowed.
double SinglePath::Error(const Piece& piece) const {
  constexpr double kTurns = 0.5;
  const double R = contact_.mu * piece.dP, speed = Length(v_);
  if (stuck_ || speed == 0) return 0;
  // where friction at its first direction would take the slip, across
  const Pair d = 1 / speed * v_;
  const Pair change = piece.dP * At(contact_.block.tn) - R * Times(A_, d);
  const Pair across = change - Dot(change, d) * d;
  const double turn = std::min(Dot(across, across) / (speed * speed), 4.0);
  return kTurns * turn * R * std::max(A_.a, A_.c) / allowed_;
}

// The part of a piece after which it changes between compression and expansion or is over; 1 if it
// does not.
double SinglePath::FractionToEnd(const Piece& piece) const {
  if (!expands_) return piece.c < 0 ? c_ / (c_ - piece.c) : 1;
  // E + (c s − a s²/2) / e² = 0
  const double a = (c_ - piece.c) / piece.dP, work = energy_ / over_e2_;
  const double root = c_ * c_ + 2 * a * work;
  const double s = root >= 0 ? 2 * work / (std::sqrt(root) - c_) : 2 * piece.dP;
  if (piece.c > 0 && c_ < 0) return std::min(s / piece.dP, c_ / (c_ - piece.c));
  return std::min(1.0, s / piece.dP);
}

void SinglePath::Accept(const Piece& piece, bool ends) {
  const StepFriction& friction = piece.friction;
  const double R = contact_.mu * piece.dP;
  // ∫ c dP, a bend of it included
  const double work =
      piece.dP * (c_ - 0.5 * (contact_.W * piece.dP + Dot(At(contact_.block.nt), friction.lead)));
  const double after = energy_ + (expands_ ? over_e2_ : 1) * work;
  over_ = ends && (expands_ ? piece.c <= 0 : over_e2_ == 0);
  AddTime(piece, over_ && expands_ ? 0 : after);
  energy_ = after;
  most_ = std::max(most_, after);
  ratio_ = 1 / piece.dP * friction.ratio;
  stuck_ = Dot(friction.ratio, friction.ratio) < kWithin * R * R;
  v_ = piece.v;
  c_ = piece.c;
  if (ends && !over_) {
    c_ = 0;
    expands_ = !expands_;
  }
}

// F = K (5 E / (2 K))³ᐟ⁵
double SinglePath::Force(double energy) const {
  return contact_.stiffness * std::pow(2.5 * energy / contact_.stiffness, 0.6);
}

// Time and moments of a piece, over which c is a straight line. Where E is zero at one end, and F
// with it, the nodes are closer there.
void SinglePath::AddTime(const Piece& piece, double after) {
  const double rate = expands_ ? over_e2_ : 1, dP = piece.dP, a = (c_ - piece.c) / dP;
  const bool begins = energy_ == 0, ends = after == 0;
  double time = 0, lag = 0;  // ∫ ds / F, ∫ s ds / F
  const bool small = !begins && !ends && dP * contact_.W < kSmall * contact_.closing_speed;
  for (int i = 0; i < (small ? 2 : kNodes); ++i) {
    const double node = small ? kNode2[i] : kNode[i], weight = small ? kWeight2[i] : kWeight[i];
    const double x = begins ? node : 1 - node, root = x * std::sqrt(x);
    double s = dP * node, ds = dP * weight;
    if (begins || ends) {
      s = begins ? dP * root * x : dP * (1 - root * x);
      ds *= 2.5 * root;
    }
    const double force = Force(energy_ + rate * s * (c_ - 0.5 * a * s));
    time += ds / force;
    lag += s * ds / force;
  }
  sum_.duration += time;
  sum_.impulse += dP;
  sum_.moment += sum_.duration * dP - lag;
  const Pair p = piece.friction.p, moment = sum_.duration * p - lag / dP * p;
  Put(sum_.friction, At(sum_.friction) + p);
  Put(sum_.friction_moment, At(sum_.friction_moment) + moment);
  ++sum_.steps;
}

SingleFriction SinglePath::Run() {
  double dP = 2 * c_ / contact_.W;
  for (int i = 0; i < kMostTries && !over_; ++i) {
    Piece piece = Try(dP);
    const double theta = piece.friction.theta;
    const bool stops = theta > kNothing && theta < 1 - kNothing;
    if (stops) {
      piece = Try(theta * dP);
      // on a line it is zero but for rounding
      if (Length(piece.v) < kStopped * allowed_) piece.v = Pair{};
    }
    const double error = Error(piece);
    const double growth = std::clamp(0.9 / std::cbrt(error + 1e-4), 0.1, 10.0);
    if (error > 1) {
      dP *= growth;
      continue;
    }
    // compression that does not slow down: a contact that jams
    if (expands_ && c_ == 0 && piece.c > 0) {
      expands_ = false;
      continue;
    }
    const double fraction = FractionToEnd(piece);
    if (fraction < 1) piece = Try(fraction * piece.dP);
    Accept(piece, fraction < 1);
    dP = growth * piece.dP;
  }
  sum_.ended = over_;
  sum_.peak = Force(most_);
  return sum_;
}

}  // namespace

SingleFriction SolveSingleFriction(const FrictionContact& contact, double tolerance) {
  return SinglePath(contact, tolerance).Run();
}

}  // namespace mujoco_impact::law
