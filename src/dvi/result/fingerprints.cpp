#include "dvi/result/fingerprints.h"

#include <fmt/format.h>

#include "dvi/core/error.h"
#include "dvi/core/hash.h"

namespace dvi::result {

std::string identity_of(const inputs::Recordings& drives) {
  std::string identity;
  for (const inputs::Recording& open : drives)
    identity += fs::absolute(open.drive.path).lexically_normal().string() + " " + open.drive.camera_name + "\n";
  return identity;
}

std::string program_fingerprint() { return compute_hash(read_file(find_own_binary())); }

std::string listing_of(const inputs::Recordings& drives) {
  Fingerprint print;
  for (const inputs::Recording& open : drives)
    for (const fs::path& file : inputs::files_of(open)) {
      std::error_code gone;
      const std::uintmax_t bytes = file.empty() ? 0 : fs::file_size(file, gone);
      print.add(fmt::format("{} {}", file.filename().string(), gone ? "gone" : std::to_string(bytes)));
    }
  return print.hex();
}

std::string content_of(const inputs::Recordings& drives) {
  Fingerprint print;
  print.add(read_file(find_own_binary()));  // another build may compute other pixels
  for (const inputs::Recording& open : drives) inputs::add_files(print, open);
  return print.hex();
}

std::string fingerprint_of(job::Job job, const std::string& content) {
  job.out.clear();
  job.memory_mb = 0;  // does not affect pixels
  return compute_hash(content + job.table().dump_toml());
}

std::string stages_fingerprint_of(job::Job job, const std::string& content) {
  job.target.clear();
  job.sources.clear();
  job.read.frames.clear();
  for (job::MasksFrom& from : job.read.masks) from.path.clear();
  job.read.detector.clear();
  job.read.ego_mask.clear();
  job.read.poses.file.clear();
  const job::Options plain;
  job.options.depth = plain.depth;
  job.options.plane_sweep = plain.plane_sweep;
  job.options.sample = plain.sample;
  job.options.regularize = plain.regularize;
  job.options.harmonize = plain.harmonize;
  job.options.smooth = plain.smooth;
  job.options.flow = plain.flow;
  job.options.video = plain.video;
  return fingerprint_of(job, content);
}

}  // namespace dvi::result
