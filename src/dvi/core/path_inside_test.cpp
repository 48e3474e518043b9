#include "dvi/core/path_inside.h"

#include <gtest/gtest.h>

#include "dvi/testing/temp_folder.h"

namespace dvi {
namespace {

TEST(PathInside, FollowsLinksAndNeedsNoFiles) {
  const TempFolder temporary;
  const fs::path folder = temporary.path / "drive";
  make_folder(folder / "images");
  fs::create_directory_symlink(folder, temporary.path / "link");
  EXPECT_TRUE(is_inside(folder, folder));
  EXPECT_TRUE(is_inside(folder / "images/../images/absent", folder));
  EXPECT_TRUE(is_inside(temporary.path / "link/images", folder));
  EXPECT_FALSE(is_inside(folder, folder / "images"));
  EXPECT_FALSE(is_inside(temporary.path / "drive2", folder)) << "its name begins with that of the folder";
}

}  // namespace
}  // namespace dvi
