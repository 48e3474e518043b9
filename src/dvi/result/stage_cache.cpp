#include "dvi/result/stage_cache.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "dvi/core/error.h"
#include "dvi/result/manifest.h"

namespace dvi::result {
namespace {

const char* const kFolder = ".dvi/stages";

std::string file_of(const std::string& name) { return fmt::format("{}/{}.bin", kFolder, name); }
fs::path manifest_of(const fs::path& out, const std::string& name) { return out / kFolder / (name + ".json"); }
std::string schema_of(const std::string& name) { return fmt::format("dvi-stage/1 {}", name); }

}  // namespace

std::vector<std::string> list_cached_stages(const fs::path& out) {
  std::vector<std::string> names;
  for (const fs::path& file : list_files(out / kFolder, {".json"})) names.push_back(file.stem().string());
  std::erase_if(names, [&](const std::string& name) { return !read_manifest(manifest_of(out, name)); });
  return names;
}

void remove_stages(const fs::path& out) {
  if (fs::is_symlink(out / kFolder)) return;
  for (const std::string& name : list_cached_stages(out)) {
    fs::remove(out / file_of(name));
    fs::remove(manifest_of(out, name));
  }
}

StageCache::StageCache(fs::path out, std::string fingerprint, Progress& progress, Missing missing)
    : out_(std::move(out)), fingerprint_(std::move(fingerprint)), progress_(progress), missing_(missing) {
  if (missing_ == Missing::refuse) return;
  make_folder(out_ / kFolder);
  remove_temporaries(out_ / kFolder);
  for (const std::string& name : list_cached_stages(out_))
    if (is_confirmed(manifest_of(out_, name), fingerprint_, out_)) valid_.insert(name);
  if (!valid_.empty()) progress_.note(fmt::format("{} of an earlier call are used", fmt::join(valid_, ", ")));
}

bool StageCache::read(const std::string& name, const std::function<void(ArchiveReader&)>& read_result) const {
  // Stages that are not computed are verified when they are read: a map is large, and not every caller reads it.
  const bool is_valid =
      missing_ == Missing::refuse ? is_confirmed(manifest_of(out_, name), fingerprint_, out_) : valid_.contains(name);
  if (!is_valid) return false;
  progress_.begin("load " + name, 0);
  std::vector<std::string> warnings;
  try {
    ArchiveReader in(out_ / file_of(name), schema_of(name));
    in >> warnings;
    read_result(in);
    in.finish();
  } catch (const InputError&) {  // answered: an unreadable stage is computed again
    return false;
  }
  progress_.end();
  for (const std::string& warning : warnings) progress_.warn(warning);
  return true;
}

void StageCache::refuse(const std::string& name) const {
  throw InputError(out_ / file_of(name), "is missing or damaged", "plan again: dvi plan --config OUT/dvi.toml");
}

void StageCache::save(const std::string& name, std::size_t warned, const std::function<void(ArchiveWriter&)>& write) const {
  std::vector<std::string> warnings = progress_.warnings();
  warnings.erase(warnings.begin(), warnings.begin() + static_cast<std::ptrdiff_t>(warned));
  ArchiveWriter out(out_ / file_of(name), schema_of(name));
  out << warnings;
  write(out);
  out.finish();
  write_manifest(manifest_of(out_, name), {fingerprint_, list_contents(out_, {file_of(name)})});
}

}  // namespace dvi::result
