#include "dvi/commands/find_recorded_input.h"

#include "dvi/core/error.h"
#include "dvi/job/job.h"

namespace dvi::commands {

exports::RecordedInput find_recorded_input(const fs::path& out) {
  if (!fs::exists(out / "dvi.toml"))
    throw InputError(out, "is not a finished result of dvi run", "give the OUT of a dvi run that has ended");
  job::Job job;
  job.table().load_toml(out / "dvi.toml");
  return {job.target, {.topics = job.read.topics}};
}

}  // namespace dvi::commands
