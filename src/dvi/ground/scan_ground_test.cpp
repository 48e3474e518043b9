#include "dvi/ground/scan_ground.h"

#include <gtest/gtest.h>

namespace dvi::ground {
namespace {

// A slope of 0.1 along x. The height of a square is that at its center.
std::vector<GroundSquare> make_slope() {
  std::vector<GroundSquare> squares;
  for (int x = -3; x < 3; ++x)
    for (int y = 0; y < 2; ++y) squares.push_back({x, y, 0.1 * (x + 0.5) + 1});
  return squares;
}

TEST(ScanGround, HasTheHeightsOfItsSquares) {
  const ScanGround ground(make_slope());
  EXPECT_NEAR(ground.height({-1.25, 1}).value(), 0.875, 1e-5);
  EXPECT_NEAR(ground.height({2, 0.75}).value(), 1.2, 1e-5);
  EXPECT_NEAR(ground.height({2.5, 3.5}).value(), 1.05, 1e-5) << "the lowest square within 2 m";
  EXPECT_FALSE(ground.height({2.5, 5}));
}

TEST(ScanGround, IsMadeOfItsSquares) {
  const std::vector<GroundSquare> slope = make_slope(), squares = ScanGround(slope).squares();
  ASSERT_EQ(squares.size(), slope.size());
  for (std::size_t i = 0; i < squares.size(); ++i) {
    EXPECT_EQ(squares[i].x, slope[i].x);
    EXPECT_EQ(squares[i].y, slope[i].y);
    EXPECT_EQ(squares[i].height_m, slope[i].height_m);
  }
  EXPECT_TRUE(ScanGround(std::vector<GroundSquare>()).squares().empty());
}

}  // namespace
}  // namespace dvi::ground
