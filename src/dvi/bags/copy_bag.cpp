#include "dvi/bags/copy_bag.h"

#include "dvi/core/text.h"

namespace dvi::bags {

void copy_bag_file(const fs::path& from, const fs::path& to, const ReplacedMessages& replaced) {
  const std::string ending = to_lower_case(from.extension().string());
  (ending == ".mcap" ? copy_mcap : ending == ".db3" ? copy_db3 : copy_ros1_bag)(from, to, replaced);
}

}  // namespace dvi::bags
