#include <array>
#include <cmath>
#include <numbers>

#include "dvi/synth/models.h"

namespace dvi::synth {
namespace {

using Eigen::Vector3d;

constexpr double kThighM = 0.45, kShankM = 0.45, kHipM = 0.9;

struct Clothes {
  TexturePtr trousers, shoes, coat, skin, hair;
};

struct Leg {
  Vector3d hip, knee, foot;  // foot: its ankle, 9 cm above the ground in the stance phase
};

// The thigh swings like a pendulum; the knee is bent while the leg swings forward.
Leg make_leg(double phase, double y) {
  const double swing = 0.45 * std::sin(phase), bend = 0.75 * std::max(0.0, std::cos(phase)) + 0.08;
  Leg leg;
  leg.hip = {0, y, kHipM};
  leg.knee = leg.hip + kThighM * Vector3d(std::sin(swing), 0, -std::cos(swing));
  leg.foot = leg.knee + kShankM * Vector3d(std::sin(swing - bend), 0, -std::cos(swing - bend));
  return leg;
}

Model make_walker_at(double phase, const Clothes& clothes) {
  const std::array<Leg, 2> legs = {make_leg(phase, 0.1), make_leg(phase + std::numbers::pi, -0.1)};
  // The lower foot is on the ground.
  const double lift = 0.09 - std::min(legs[0].foot.z(), legs[1].foot.z());
  const Vector3d up(0, 0, lift);
  Model model{"pedestrian", {}, {1.2, 0.56, 1.84}};
  Solid& solid = model.solid;
  for (const Leg& leg : legs) {
    const Vector3d foot = leg.foot + up;
    add_limb(solid, {leg.knee + up, leg.hip + up, 0.085}, clothes.trousers);
    add_limb(solid, {foot, leg.knee + up, 0.07}, clothes.trousers);
    Solid shoe;
    add_frustum(shoe, {foot.x() - 0.09, foot.x() + 0.18, 0.055, foot.z() - 0.09},
                {foot.x() - 0.08, foot.x() + 0.08, 0.055, foot.z()},
                {clothes.shoes, clothes.shoes, clothes.shoes, clothes.shoes, clothes.shoes});
    solid.add(shoe, {Eigen::Matrix3d::Identity(), {0, foot.y(), 0}});
  }
  for (const double side : {1.0, -1.0}) {  // arms swing opposite to the legs
    const double swing = -0.4 * side * std::sin(phase);
    const Vector3d shoulder = Vector3d(0, 0.215 * side, 1.4) + up;
    add_limb(solid, {shoulder + 0.62 * Vector3d(std::sin(swing), 0, -std::cos(swing)), shoulder, 0.055}, clothes.coat);
  }
  add_limb(solid, {Vector3d(0, 0, 0.8) + up, Vector3d(0, 0, 1.45) + up, 0.155}, clothes.coat);
  add_limb(solid, {Vector3d(0.01, 0, 1.45) + up, Vector3d(0.01, 0, 1.64) + up, 0.1}, clothes.skin);
  add_limb(solid, {Vector3d(0, 0, 1.62) + up, Vector3d(0, 0, 1.74) + up, 0.11}, clothes.hair);
  solid.finish();
  return model;
}

}  // namespace

std::vector<Model> make_walker(Random random, const Noise& noise) {
  Clothes clothes;
  clothes.trousers = paint_plain(random, noise, random_color(random, 25, 90));
  clothes.shoes = paint_plain(random, noise, {30, 30, 34});
  clothes.coat = paint_plain(random, noise, random_color(random, 40, 220));
  clothes.skin = paint_plain(random, noise, {130, 160, 200});
  clothes.hair = paint_plain(random, noise, random_color(random, 20, 70));
  std::vector<Model> gait;
  for (int i = 0; i < kGaitPhases; ++i) gait.push_back(make_walker_at(2 * std::numbers::pi * i / kGaitPhases, clothes));
  return gait;
}

}  // namespace dvi::synth
