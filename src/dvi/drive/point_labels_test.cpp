#include "dvi/drive/point_labels.h"

#include <gtest/gtest.h>

namespace dvi {
namespace {

TEST(PointClassIds, DependOnTypeAndMotion) {
  EXPECT_EQ(point_class_id("car", false), 10);
  EXPECT_EQ(point_class_id("van", true), 252);
  EXPECT_EQ(point_class_id("pedestrian", true), 254);
  EXPECT_EQ(point_class_id("tram", true), 256);
  EXPECT_EQ(point_class_id("cyclist", false), 31);
  EXPECT_EQ(point_class_id("bicycle", false), 11);
  EXPECT_EQ(point_class_id("bicycle", true), 253) << "with its rider";
  EXPECT_EQ(point_class_id("motorcycle", true), 255);
  EXPECT_EQ(point_class_id("", true), 259);
  EXPECT_EQ(point_class_id("excavator", false), 20);
}

}  // namespace
}  // namespace dvi
