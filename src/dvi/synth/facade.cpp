#include "dvi/synth/facade.h"

#include <array>
#include <cmath>

namespace dvi::synth {
namespace {

constexpr double kPixelsPerMeter = 45;
constexpr double kStoryM = 3.0, kShopHeightM = 3.7;

std::string choose_shop_name(Random& random) {
  static const std::array<const char*, 18> kNames = {"CAFE",   "BANK",  "HOTEL",   "BOOKS",  "PHARMACY", "NOODLES",
                                                     "SHOES",  "24 H",  "BAKERY",  "TAXI",   "MUSIC",    "REPAIR",
                                                     "OPTICS", "PIZZA", "FLOWERS", "PHONES", "TAILOR",   "CINEMA"};
  return kNames[random.below(static_cast<int>(kNames.size()))];
}

void paint_wall(Canvas& canvas, Random& random, const cv::Scalar& base) {
  const int kind = random.below(3);
  const cv::Scalar joint = base * 0.78;
  if (kind == 0) {  // bricks
    for (double z = 0; z < canvas.height(); z += 0.24) canvas.line({0, z}, {canvas.width(), z}, joint, 1);
    for (int row = 0; row * 0.24 < canvas.height(); ++row)
      for (double x = (row % 2) * 0.25; x < canvas.width(); x += 0.5) {
        if (random.below(4) == 0) canvas.box({x, row * 0.24, 0.48, 0.22}, base * random.uniform(0.86, 1.12));
        canvas.line({x, row * 0.24}, {x, row * 0.24 + 0.22}, joint, 1);
      }
  } else if (kind == 1) {  // slabs
    for (double z = 0; z < canvas.height(); z += 1.0)
      for (double x = 0; x < canvas.width(); x += 1.4) {
        canvas.box({x, z, 1.4, 1.0}, base * random.uniform(0.93, 1.06));
        canvas.frame({x, z, 1.4, 1.0}, joint, 1);
      }
  }
  for (int i = 0; i < 12; ++i) {  // rain marks below ledges
    const double x = random.uniform(0, canvas.width()), z = random.uniform(3, canvas.height());
    const double tone = random.uniform(0.84, 0.95), h = random.uniform(0.5, 1.8), w = random.uniform(0.04, 0.2);
    canvas.box({x, z - random.uniform(0.5, 2), w, h}, base * tone);
  }
}

void paint_window(Canvas& canvas, Random& random, const cv::Rect2d& pane, const cv::Scalar& trim) {
  const double x = pane.x, z = pane.y, w = pane.width, h = pane.height;
  const double dark = random.uniform(30, 85);
  canvas.box({x - 0.1, z - 0.1, w + 0.2, h + 0.2}, trim);
  canvas.box({x - 0.16, z - 0.18, w + 0.32, 0.1}, trim * 0.8);  // sill
  canvas.box(pane, {dark * 1.3, dark * 1.1, dark});
  canvas.box({x, z + 0.62 * h, w, 0.38 * h}, {dark * 1.7 + 12, dark * 1.45 + 10, dark * 1.3 + 8});  // sky in the glass
  canvas.line({x + 0.1 * w, z + 0.1 * h}, {x + 0.8 * w, z + 0.95 * h}, {dark * 2 + 40, dark * 1.9 + 35, dark * 1.8 + 30}, 2);
  const int curtain = random.below(5);
  if (curtain == 0) canvas.box({x, z + 0.35 * h, w, 0.65 * h}, random_color(random, 110, 225));
  if (curtain == 1) {
    const cv::Scalar cloth = random_color(random, 120, 220);
    canvas.box({x, z, 0.25 * w, h}, cloth);
    canvas.box({x + 0.75 * w, z, 0.25 * w, h}, cloth);
  }
  const cv::Scalar bar = trim * 1.1;
  canvas.line({x + 0.5 * w, z}, {x + 0.5 * w, z + h}, bar, 2);
  canvas.line({x, z + 0.6 * h}, {x + w, z + 0.6 * h}, bar, 2);
}

void paint_stories(Canvas& canvas, Random& random, const cv::Scalar& base) {
  const double pitch = random.uniform(1.7, 2.7), w = pitch * random.uniform(0.48, 0.7), h = random.uniform(1.4, 1.9);
  const cv::Scalar trim = random.below(2) == 0 ? base * 1.3 : cv::Scalar(205, 212, 215);
  const bool balconies = random.below(3) == 0;
  for (double z = kShopHeightM + 0.8; z + h < canvas.height() - 0.6; z += kStoryM) {
    canvas.box({0, z - 0.55, canvas.width(), 0.09}, base * 0.82);
    for (double x = 0.6; x + w < canvas.width() - 0.4; x += pitch) {
      paint_window(canvas, random, {x, z, w, h}, trim);
      if (!balconies || random.below(3) != 0) continue;
      canvas.box({x - 0.2, z - 0.35, w + 0.4, 0.14}, base * 0.6);
      for (double bar = x - 0.2; bar < x + w + 0.2; bar += 0.13) canvas.line({bar, z - 0.25}, {bar, z + 0.55}, {45, 45, 48}, 1);
      canvas.line({x - 0.2, z + 0.55}, {x + w + 0.2, z + 0.55}, {40, 40, 42}, 2);
    }
  }
}

void paint_goods(Canvas& canvas, Random& random, double x, double w) {
  for (int i = 0; i < 14; ++i) {
    const double gw = random.uniform(0.12, 0.55), gh = random.uniform(0.12, 0.7);
    const cv::Scalar color = random_color(random, 50, 235);
    const double z = random.uniform(0.45, 2.0);
    canvas.box({x + random.uniform(0, std::max(0.05, w - gw)), z, gw, gh}, color);
  }
}

void paint_shop(Canvas& canvas, Random& random, double x, double w) {
  const cv::Scalar board = random_color(random, 20, 210);
  const bool light_words = board[0] + board[1] + board[2] < 380;
  canvas.box({x, 0, w, 2.65}, random_color(random, 40, 95));
  paint_goods(canvas, random, x, w);
  canvas.line({x + 0.1 * w, 0.4}, {x + 0.45 * w, 2.6}, {150, 150, 146}, 3);
  for (double bar = x; bar < x + w; bar += w / 3) canvas.line({bar, 0}, {bar, 2.65}, {165, 168, 170}, 3);
  canvas.box({x, 0, w, 0.35}, board * 0.6);
  const double door = x + w / 3 * random.below(3);
  canvas.box({door + 0.08, 0, w / 3 - 0.12, 2.3}, board * 0.45);
  canvas.box({door + 0.2, 0.5, w / 3 - 0.36, 1.6}, {95, 88, 80});
  canvas.box({x - 0.08, 2.7, w + 0.16, 0.75}, board);
  canvas.text({x + 0.1, 2.8, w - 0.2, 0.52}, choose_shop_name(random),
              light_words ? cv::Scalar(240, 240, 240) : cv::Scalar(25, 25, 30));
}

}  // namespace

TexturePtr paint_facade(Random random, const Noise& noise, double width_m, double height_m) {
  const double gray = random.uniform(110, 190);
  const cv::Scalar base(gray * random.uniform(0.7, 1.0), gray * random.uniform(0.85, 1.0), gray * random.uniform(0.95, 1.15));
  Canvas canvas(width_m, height_m, kPixelsPerMeter, base);
  paint_wall(canvas, random, base);
  paint_stories(canvas, random, base);
  canvas.box({0, 0, canvas.width(), kShopHeightM}, base * 0.88);
  const int shops = std::max(1, static_cast<int>(std::lround(width_m / random.uniform(3.2, 5.0))));
  for (int i = 0; i < shops; ++i) {
    const double w = (width_m - 0.4) / shops;
    paint_shop(canvas, random, 0.3 + i * w, w - 0.35);
  }
  canvas.box({0, kShopHeightM - 0.1, canvas.width(), 0.16}, base * 1.15);
  canvas.box({0, canvas.height() - 0.5, canvas.width(), 0.5}, base * 0.72);
  canvas.box({0, canvas.height() - 0.62, canvas.width(), 0.1}, base * 1.25);
  canvas.box({0, 0, 0.12, canvas.height()}, base * 0.55);
  canvas.box({0.3, 0, 0.09, canvas.height() - 0.5}, {88, 92, 94});  // rain pipe
  roughen(canvas.picture, noise, 7, {random.below(512), random.below(512)});
  return std::make_shared<Texture>(canvas.picture);
}

TexturePtr paint_sign(Random random, const Noise& noise, double width_m, double height_m) {
  const cv::Scalar board = random_color(random, 20, 230);
  Canvas canvas(width_m, height_m, 100, board);
  const cv::Scalar ink = board[0] + board[1] + board[2] < 380 ? cv::Scalar(245, 245, 245) : cv::Scalar(30, 25, 60);
  canvas.frame({0.04, 0.04, width_m - 0.08, height_m - 0.08}, ink, 3);
  const int rows = std::max(1, static_cast<int>(height_m / 0.45));
  for (int i = 0; i < rows; ++i)
    canvas.text({0.1, 0.1 + i * (height_m - 0.2) / rows, width_m - 0.2, 0.7 * (height_m - 0.2) / rows},
                choose_shop_name(random), ink);
  roughen(canvas.picture, noise, 4, {random.below(512), random.below(512)});
  return std::make_shared<Texture>(canvas.picture);
}

TexturePtr paint_barrier(Random random, const Noise& noise) {
  Canvas canvas(1.8, 0.25, 100, {225, 228, 230});
  for (double x = 0; x < 1.8; x += 0.4)
    for (double z = 0; z < 0.25; z += 0.01) canvas.box({x + 0.4 * z, z, 0.2, 0.01}, {40, 35, 190});
  roughen(canvas.picture, noise, 5, {random.below(512), random.below(512)});
  return std::make_shared<Texture>(canvas.picture);
}

}  // namespace dvi::synth
