#pragma once

#include <functional>
#include <set>
#include <string>
#include <type_traits>
#include <utility>

#include "dvi/core/progress.h"
#include "dvi/result/archive.h"

namespace dvi::result {

/// Caches the results of whole stages in the output folder, so that later calls do not compute them again.
///
/// OUT/.dvi/stages/NAME.bin (archive.h) contains a stage's warnings and its result, but no paths and no time. NAME.json is its
/// manifest, written after it. A stage whose files differ from the manifest is computed again.
class StageCache {
 public:
  /// The treatment of stages that are not cached: they are computed, or refused with an InputError.
  enum class Missing { compute, refuse };

  /// Lists the cached stages that have this fingerprint, and reports them with `progress`, if missing stages are computed.
  /// `fingerprint` identifies everything that the stages depend on.
  StageCache(fs::path out, std::string fingerprint, Progress& progress, Missing missing = Missing::compute);

  /// Returns the cached result of the stage `name`, and repeats its warnings. If it is not cached, calls `make`, and saves the
  /// result. `result` is the object to read into, which may have an allocator.
  template <class Make, class Result = std::invoke_result_t<Make>>
  Result load_or_compute(const std::string& name, const Make& make, Result result = Result()) const {
    if (read(name, [&](ArchiveReader& in) { in >> result; })) return result;
    if (missing_ == Missing::refuse) refuse(name);
    const std::size_t warned = progress_.warnings().size();
    result = make();
    save(name, warned, [&](ArchiveWriter& out) { out << result; });
    return result;
  }

  /// Returns the cached result of a stage, and repeats its warnings. Throws InputError if it is not cached. `result` as above.
  template <class Result>
  Result load(const std::string& name, Result result = Result()) const {
    if (!read(name, [&](ArchiveReader& in) { in >> result; })) refuse(name);
    return result;
  }

 private:
  bool read(const std::string& name, const std::function<void(ArchiveReader&)>& read_result) const;
  [[noreturn]] void refuse(const std::string& name) const;
  void save(const std::string& name, std::size_t warned, const std::function<void(ArchiveWriter&)>& write) const;

  const fs::path out_;
  const std::string fingerprint_;
  Progress& progress_;
  std::set<std::string> valid_;  // names, if missing stages are computed
  const Missing missing_;
};

/// Returns the names of all stages that have a manifest in OUT, with any fingerprint, sorted.
std::vector<std::string> list_cached_stages(const fs::path& out);

/// Removes all cached stages, for a result of another method, which does not use them.
void remove_stages(const fs::path& out);

}  // namespace dvi::result
