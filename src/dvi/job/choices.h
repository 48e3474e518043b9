#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "dvi/core/named.h"
#include "dvi/labels/mask_reading.h"
#include "dvi/objects/evidence.h"

namespace dvi::job {

using dvi::to_string;  // for the enums below, beside the overloads of this namespace

/// The values of `--method`: the method of this program, its published form, and baselines without depth.
enum class Method { dvi, paper, flow, telea, ns };
constexpr auto names_of(Method) {
  return std::array{std::pair{Method::dvi, "dvi"}, std::pair{Method::paper, "paper"}, std::pair{Method::flow, "flow"},
                    std::pair{Method::telea, "telea"}, std::pair{Method::ns, "ns"}};
}

/// Whether a method uses images and masks only, without poses and scans.
constexpr bool is_baseline(Method method) { return method != Method::dvi && method != Method::paper; }

using objects::Remove;

/// The values of `--poses`. automatic: given or loam, whichever makes the sharper map.
struct PosesFrom {
  enum class Kind { automatic, given, loam, file };
  Kind kind = Kind::automatic;
  std::string file = {};  ///< the file of poses, for Kind::file

  static PosesFrom parse(const std::string& text);  ///< any text that is not a keyword is a file
};
constexpr auto names_of(PosesFrom::Kind) {
  using Kind = PosesFrom::Kind;
  return std::array{std::pair{Kind::automatic, "auto"}, std::pair{Kind::given, "given"}, std::pair{Kind::loam, "loam"}};
}
std::string to_string(const PosesFrom& from);

/// One value of `--masks`. automatic: the mask files of the drive, else its labels, else moving objects. found: moving objects,
/// even if the drive has masks or labels. none: nothing, so that other sources are used alone.
struct MasksFrom {
  enum class Kind { automatic, labels, found, none, path };
  Kind kind = Kind::automatic;
  std::string path = {};                                    ///< a folder of PNG files or a file of labels, for Kind::path
  labels::Polarity polarity = labels::Polarity::automatic;  ///< of this folder; automatic: that of `--polarity`

  /// Parses a keyword or a path, which may follow "white:" or "black:".
  static MasksFrom parse(const std::string& text);
  bool operator==(const MasksFrom&) const = default;
};
constexpr auto names_of(MasksFrom::Kind) {
  using Kind = MasksFrom::Kind;
  return std::array{std::pair{Kind::automatic, "auto"}, std::pair{Kind::labels, "labels"}, std::pair{Kind::found, "found"},
                    std::pair{Kind::none, "none"}};
}
std::string to_string(const MasksFrom& from);
/// Formats several values, separated by blanks.
std::string to_string(const std::vector<MasksFrom>& sources);

}  // namespace dvi::job
