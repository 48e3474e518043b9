#pragma once

#include <functional>
#include <set>
#include <string>
#include <type_traits>
#include <utility>

#include "dvi/core/progress.h"
#include "dvi/result/archive.h"

namespace dvi::result {

/// Results of whole stages, so that no later call computes them again.
///
/// OUT/.dvi/stages/NAME.bin (archive.h) holds a stage's warnings and its result, and says neither where nor when it was
/// made. NAME.json is its manifest, written after it. What the manifest does not confirm is made again.
class StageCache {
 public:
  enum class Missing { made, refused };

  /// Notes which stages of an earlier call will be used. `fingerprint`: of all that the stages depend on. `missing`: what
  /// becomes of the others; refused is an InputError.
  StageCache(fs::path out, std::string fingerprint, Progress& progress, Missing missing = Missing::made);

  /// What `make` returned to an earlier call, its warnings repeated; otherwise what it returns now. `result`: where to read to.
  template <class Make, class Result = std::invoke_result_t<Make>>
  Result cached(const std::string& name, const Make& make, Result result = Result()) const {
    if (load(name, [&](ArchiveReader& in) { in >> result; })) return result;
    refuse_if_missing(name);
    const std::size_t warned = progress_.warnings().size();
    result = make();
    save(name, warned, [&](ArchiveWriter& out) { out << result; });
    return result;
  }

 private:
  bool load(const std::string& name, const std::function<void(ArchiveReader&)>& read) const;
  void refuse_if_missing(const std::string& name) const;
  void save(const std::string& name, std::size_t warned, const std::function<void(ArchiveWriter&)>& write) const;

  const fs::path out_;
  const std::string fingerprint_;
  Progress& progress_;
  std::set<std::string> held_;  // names
  const Missing missing_;
};

/// The stages that manifests in OUT name, whatever they were made from, by name.
std::vector<std::string> cached_stages(const fs::path& out);

/// Removes them: a result that is of another method now has no use for them.
void remove_stages(const fs::path& out);

}  // namespace dvi::result
