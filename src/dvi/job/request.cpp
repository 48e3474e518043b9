#include "dvi/job/request.h"

namespace dvi::job {
namespace {

// A path that does not exist stays as it is, so that the message quotes the user's text.
void make_absolute(std::string& path) {
  if (!path.empty() && fs::exists(path)) path = fs::absolute(path).lexically_normal().string();
}

}  // namespace

Job Request::job(const std::string& out, const std::string& target, const std::vector<std::string>& sources) const {
  Job job;
  OptionTable table = job.table();
  bool method = false;
  if (!config.empty()) table.load_toml(config);
  for (const Assignment& assignment : assignments) {
    const std::string name = table.find(assignment.option).name();
    method |= name == "job.method";
    if (name == "job.method") table.assign(assignment);
  }
  use_method(job.method, job.options);
  // Once more: the single options of the file override the values of the method that it names.
  if (!config.empty() && !method) table.load_toml(config);
  for (const Assignment& assignment : assignments) table.assign(assignment);
  job.options.check();
  if (!job.read.frames.empty()) parse_frames(job.read.frames);
  if (!out.empty()) job.out = out;
  if (!target.empty()) {
    job.target = target;
    job.sources = sources;
  }
  for (std::string* path : {&job.target, &job.read.ego_mask, &job.read.detector, &job.read.poses.file}) make_absolute(*path);
  for (MasksFrom& from : job.read.masks) make_absolute(from.path);
  for (std::string& path : job.sources) make_absolute(path);
  return job;
}

}  // namespace dvi::job
