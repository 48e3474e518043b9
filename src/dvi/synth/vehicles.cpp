#include <array>
#include <cmath>

#include "dvi/synth/models.h"

namespace dvi::synth {
namespace {

using Eigen::Vector3d;

constexpr double kBodyPixelsPerMeter = 100;
const cv::Scalar kTire(24, 24, 25), kGlass(62, 52, 45), kPlate(226, 228, 226), kRed(40, 35, 200);

cv::Scalar choose_car_color(Random& random) {
  static const std::array<cv::Scalar, 9> kColors = {cv::Scalar(205, 208, 210),
                                                    {40, 38, 38},
                                                    {150, 148, 145},
                                                    {45, 40, 170},
                                                    {150, 85, 40},
                                                    {70, 95, 60},
                                                    {60, 140, 190},
                                                    {110, 60, 30},
                                                    {95, 92, 90}};
  return kColors[static_cast<std::size_t>(random.below(static_cast<int>(kColors.size())))] * random.uniform(0.85, 1.12);
}

/// The color of a part, its noise, and the random numbers of its details.
struct Paint {
  Random random;
  const Noise& noise;
  cv::Scalar color;
};

TexturePtr finish(Canvas& canvas, Paint& paint, double amplitude = 3.5) {
  roughen(canvas.picture, paint.noise, amplitude, {paint.random.below(512), paint.random.below(512)});
  return std::make_shared<Texture>(canvas.picture, canvas.alpha);
}

void paint_wheel(Canvas& canvas, double x, double radius) {
  canvas.disc(x, radius, radius + 0.05, {30, 30, 30});
  canvas.disc(x, radius, radius, kTire);
  canvas.disc(x, radius, 0.6 * radius, {150, 152, 155});
  for (double angle = 0; angle < 6; angle += 1.2566)
    canvas.line({x, radius}, {x + 0.55 * radius * std::cos(angle), radius + 0.55 * radius * std::sin(angle)}, {70, 70, 72}, 4);
  canvas.disc(x, radius, 0.15 * radius, {90, 92, 95});
  canvas.uncut(x, radius, radius);
}

// Paints a side with the front to the left; wheels and a gap are below the body.
TexturePtr paint_side(Paint paint, cv::Size2d size, double sill) {
  const double length = size.width, height = size.height;
  const cv::Scalar& color = paint.color;
  Canvas canvas(length, height, kBodyPixelsPerMeter, color);
  canvas.cut_below(sill);
  canvas.box({0, sill, length, 0.14}, color * 0.45);
  canvas.line({0, 0.72 * height}, {length, 0.76 * height}, color * 1.25, 3);
  canvas.line({0, 0.66 * height}, {length, 0.70 * height}, color * 0.72, 2);
  for (const double x : {0.36, 0.58}) {
    canvas.line({x * length, sill + 0.1}, {x * length, height}, color * 0.5, 2);
    canvas.box({x * length - 0.3, 0.78 * height, 0.2, 0.04}, color * 0.6);
  }
  canvas.box({0, 0.6 * height, 0.3, 0.17 * height}, {215, 220, 222});
  canvas.box({length - 0.22, 0.6 * height, 0.22, 0.2 * height}, kRed);
  paint_wheel(canvas, 0.19 * length, 0.32);
  paint_wheel(canvas, 0.8 * length, 0.32);
  return finish(canvas, paint);
}

enum class End { front, rear };

TexturePtr paint_end(Paint paint, cv::Size2d size, End end) {
  const double width = size.width, height = size.height;
  const bool front = end == End::front;
  Canvas canvas(width, height, kBodyPixelsPerMeter, paint.color);
  canvas.box({0, 0, width, 0.3 * height}, paint.color * 0.5);
  canvas.line({0, 0.33 * height}, {width, 0.33 * height}, paint.color * 0.35, 2);
  const cv::Scalar lamp = front ? cv::Scalar(220, 225, 228) : kRed;
  for (const double x : {0.04, width - 0.38}) {
    canvas.box({x, 0.52 * height, 0.34, 0.24 * height}, lamp);
    canvas.box({x + 0.04, 0.55 * height, 0.1, 0.15 * height}, front ? lamp * 0.7 : cv::Scalar(60, 150, 235));
  }
  if (front)
    for (double z = 0.4; z < 0.72; z += 0.09) canvas.box({0.5, z * height, width - 1.0, 0.05 * height}, {35, 35, 35});
  canvas.box({0.5 * width - 0.27, 0.34 * height, 0.54, 0.13}, kPlate);
  canvas.text({0.5 * width - 0.25, 0.345 * height, 0.5, 0.11}, "DV " + std::to_string(100 + paint.random.below(900)),
              {40, 30, 30});
  return finish(canvas, paint);
}

TexturePtr paint_glass(Paint paint, cv::Size2d size, int bars) {
  const double width = size.width, height = size.height;
  Canvas canvas(width, height, kBodyPixelsPerMeter, paint.color);
  canvas.box({0.06, 0.04, width - 0.12, height - 0.1}, kGlass);
  canvas.box({0.06, 0.55 * height, width - 0.12, 0.45 * height - 0.06}, kGlass * 1.6);
  canvas.line({0.25 * width, 0.06}, {0.5 * width, height - 0.08}, {140, 135, 128}, 5);
  canvas.line({0.32 * width, 0.06}, {0.56 * width, height - 0.08}, {115, 108, 100}, 3);
  for (int i = 1; i <= bars; ++i) canvas.box({width * i / (bars + 1) - 0.04, 0, 0.08, height}, paint.color * 0.7);
  return finish(canvas, paint);
}

enum class CargoSide { flank, doors };

TexturePtr paint_cargo(Paint paint, cv::Size2d size, CargoSide side) {
  const double width = size.width, height = size.height;
  const cv::Scalar& color = paint.color;
  const bool doors = side == CargoSide::doors;
  Canvas canvas(width, height, 80, color);
  for (double x = 0; x < width; x += 0.6) canvas.line({x, 0}, {x, height}, color * 0.86, 2);
  canvas.frame({0.05, 0.05, width - 0.1, height - 0.1}, color * 0.6, 4);
  if (doors) {
    canvas.line({0.5 * width, 0}, {0.5 * width, height}, color * 0.4, 4);
    for (const double x : {0.4, 0.6}) canvas.line({x * width, 0.1}, {x * width, height - 0.1}, {120, 122, 125}, 4);
  }
  canvas.text({0.1 * width, 0.45 * height, 0.8 * width, 0.28 * height}, doors ? "CARGO" : "NORD CARGO",
              random_color(paint.random, 20, 160));
  canvas.box({0, 0, width, 0.12}, kRed * 0.7);
  return finish(canvas, paint, 5);
}

// Adds the body up to the belt line, as long and wide as the model, with wheels below the sill. Returns the sheet metal.
TexturePtr add_body(Model& model, const Paint& paint, double belt, double sill) {
  const double length = model.size.x(), half = 0.5 * length, width = model.size.y(), h = 0.5 * width;
  const TexturePtr side = paint_side(paint, {length, belt}, sill),
                   plain = paint_plain(paint.random, paint.noise, paint.color * 1.05, 3);
  add_frustum(model.solid, {-half, half, h, 0}, {-half, half, h, belt}, {side, side, {}, {}, plain});
  add_frustum(
      model.solid, {-half, half, h, sill}, {-half, half, h, belt},
      {{}, {}, paint_end(paint, {width, belt - sill}, End::front), paint_end(paint, {width, belt - sill}, End::rear), {}});
  return plain;
}

}  // namespace

Model make_car(Random random, const Noise& noise) {
  const cv::Scalar color = choose_car_color(random);
  const double length = random.uniform(3.9, 4.7), half = 0.5 * length, width = random.uniform(1.7, 1.85), h = 0.5 * width;
  const double belt = random.uniform(0.86, 0.95), roof = belt + random.uniform(0.48, 0.6), sill = 0.26;
  Model model{"car", {}, {length, width, roof}};
  const Paint paint{random, noise, color};
  const TexturePtr plain = add_body(model, paint, belt, sill);
  const TexturePtr pane = paint_glass(paint, {width, 0.6}, 0), panes = paint_glass(paint, {0.6 * length, 0.55}, 2);
  add_frustum(model.solid, {-half + 0.15, half - 1.15, h - 0.03, belt}, {-half + 0.65, half - 1.9, h - 0.2, roof},
              {panes, panes, pane, pane, plain});
  model.solid.finish();
  return model;
}

Model make_van(Random random, const Noise& noise) {
  const cv::Scalar color = choose_car_color(random);
  const double length = random.uniform(4.9, 5.4), half = 0.5 * length, width = 1.95, h = 0.5 * width, belt = 1.15, roof = 2.15,
               sill = 0.3;
  Model model{"van", {}, {length, width, roof}};
  const Paint paint{random, noise, color};
  const TexturePtr plain = add_body(model, paint, belt, sill);
  const TexturePtr pane = paint_glass(paint, {width, 1.0}, 0), back = paint_glass(paint, {width, 1.0}, 1);
  const TexturePtr sides = paint_glass(paint, {0.8 * length, 1.0}, 3);
  add_frustum(model.solid, {-half, half - 0.7, h, belt}, {-half + 0.05, half - 1.4, h - 0.08, roof},
              {sides, sides, pane, back, plain});
  model.solid.finish();
  return model;
}

Model make_truck(Random random, const Noise& noise) {
  const cv::Scalar cab_color = choose_car_color(random), box_color = random_color(random, 120, 230);
  const Paint cab{random, noise, cab_color}, box{random, noise, box_color};
  const double length = 8.2, half = 0.5 * length, width = 2.45, h = 0.5 * width;
  Model model{"truck", {}, {length, width, 3.5}};
  const TexturePtr chassis = paint_side({random, noise, {60, 60, 62}}, {length, 0.95}, 0.45),
                   top = paint_plain(random, noise, box_color);
  add_frustum(model.solid, {-half, half, h - 0.05, 0}, {-half, half, h - 0.05, 0.95}, {chassis, chassis, {}, {}, {}});
  add_frustum(model.solid, {-half, half, h - 0.05, 0.45}, {-half, half, h - 0.05, 0.95},
              {{}, {}, {}, paint_end({random, noise, {70, 70, 72}}, {width, 0.5}, End::rear), {}});
  const TexturePtr flank = paint_cargo(box, {6, 2.5}, CargoSide::flank),
                   doors = paint_cargo(box, {width, 2.5}, CargoSide::doors);
  add_frustum(model.solid, {-half, half - 2.1, h, 0.95}, {-half, half - 2.1, h, 3.5}, {flank, flank, top, doors, top, false});
  const TexturePtr front = paint_end(cab, {width, 1.1}, End::front), pane = paint_glass(cab, {width, 1.0}, 0);
  const TexturePtr door = paint_glass(cab, {1.9, 1.0}, 0), low = paint_plain(random, noise, cab_color);
  add_frustum(model.solid, {half - 1.95, half, h, 0.45}, {half - 1.95, half, h, 1.6}, {low, low, front, low, {}});
  add_frustum(model.solid, {half - 1.95, half, h, 1.6}, {half - 1.95, half - 0.25, h - 0.05, 2.7},
              {door, door, pane, low, low});
  model.solid.finish();
  return model;
}

Model make_pedestrian(Random random, const Noise& noise) {
  const TexturePtr trousers = paint_plain(random, noise, random_color(random, 25, 110)),
                   coat = paint_plain(random, noise, random_color(random, 30, 210));
  const TexturePtr skin = paint_plain(random, noise, {130, 160, 200}),
                   hair = paint_plain(random, noise, random_color(random, 20, 70));
  Model model{"pedestrian", {}, {0.8, 0.56, 1.76}};
  add_limb(model.solid, {{0.28, 0.1, 0}, {0, 0.1, 0.88}, 0.085}, trousers);
  add_limb(model.solid, {{-0.28, -0.1, 0}, {0, -0.1, 0.88}, 0.085}, trousers);
  add_limb(model.solid, {{0, 0, 0.82}, {0, 0, 1.45}, 0.155}, coat);
  add_limb(model.solid, {{-0.2, 0.215, 0.75}, {0, 0.215, 1.42}, 0.06}, coat);
  add_limb(model.solid, {{0.22, -0.215, 0.75}, {0, -0.215, 1.42}, 0.06}, coat);
  add_limb(model.solid, {{0.01, 0, 1.45}, {0.01, 0, 1.64}, 0.1}, skin);
  add_limb(model.solid, {{0, 0, 1.62}, {0, 0, 1.76}, 0.11}, hair);
  model.solid.finish();
  return model;
}

}  // namespace dvi::synth
