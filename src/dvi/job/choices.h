#pragma once

#include <array>
#include <string>
#include <utility>

#include "dvi/core/named.h"
#include "dvi/objects/evidence.h"

namespace dvi::job {

using dvi::to_string;  // of the enums below, beside the overloads of this namespace

/// What `--method` takes: ours, its published form, and baselines without depth.
enum class Method { dvi, paper, flow, telea, ns };
constexpr auto names_of(Method) {
  return std::array{std::pair{Method::dvi, "dvi"}, std::pair{Method::paper, "paper"}, std::pair{Method::flow, "flow"},
                    std::pair{Method::telea, "telea"}, std::pair{Method::ns, "ns"}};
}

/// Whether a method looks at images and masks only: it needs no poses and no scans.
constexpr bool is_baseline(Method method) { return method != Method::dvi && method != Method::paper; }

using objects::Remove;

/// What `--poses` takes. automatic: given or loam, whichever makes the sharper map.
struct PosesFrom {
  enum class Kind { automatic, given, loam, file };
  Kind kind = Kind::automatic;
  std::string file = {};  ///< of poses, where the kind says so

  static PosesFrom parse(const std::string& text);  ///< whatever is no word is a file
};
constexpr auto names_of(PosesFrom::Kind) {
  using Kind = PosesFrom::Kind;
  return std::array{std::pair{Kind::automatic, "auto"}, std::pair{Kind::given, "given"}, std::pair{Kind::loam, "loam"}};
}
std::string to_string(const PosesFrom& from);

/// What `--masks` takes. automatic: what the drive brings, mask files before labels, and what moves if it brings neither.
/// found: what moves, whatever the drive brings.
struct MasksFrom {
  enum class Kind { automatic, labels, found, path };
  Kind kind = Kind::automatic;
  std::string path = {};  ///< a folder of PNG or a file of labels, where the kind says so

  static MasksFrom parse(const std::string& text);  ///< whatever is no word is a path
};
constexpr auto names_of(MasksFrom::Kind) {
  using Kind = MasksFrom::Kind;
  return std::array{std::pair{Kind::automatic, "auto"}, std::pair{Kind::labels, "labels"}, std::pair{Kind::found, "found"}};
}
std::string to_string(const MasksFrom& from);

}  // namespace dvi::job
