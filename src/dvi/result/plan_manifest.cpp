#include "dvi/result/plan_manifest.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "dvi/core/error.h"
#include "dvi/result/fingerprints.h"
#include "dvi/result/manifest.h"

namespace dvi::result {
namespace {

fs::path plan_file(const fs::path& out) { return out / ".dvi/plan.json"; }
fs::path costs_folder(const fs::path& out) { return out / ".dvi/costs"; }

}  // namespace

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PlanManifest, version, program, listing, content, fingerprint, sections)

void write_plan(const fs::path& out, const PlanManifest& plan) { write_manifest(plan_file(out), plan.fingerprint, plan); }

PlanManifest read_plan(const fs::path& out) {
  if (!fs::is_regular_file(plan_file(out)) || !fs::is_regular_file(out / "dvi.toml"))
    throw InputError(out, "does not contain a plan", "make one with dvi plan TARGET -o OUT");
  try {
    if (const std::optional<Manifest> plan = read_manifest(plan_file(out)); plan && plan->content)
      return plan->content->get<PlanManifest>();
  } catch (const nlohmann::json::exception&) {  // answered below
  }
  throw InputError(plan_file(out), "is damaged, or was written by another version of dvi",
                   "make it again: dvi plan --config OUT/dvi.toml");
}

void require_plan_of(const fs::path& out, const job::Job& job, const inputs::Recordings& drives, const std::string& content) {
  const PlanManifest plan = read_plan(out);
  const std::string again = fmt::format("plan again: dvi plan --config {}", (out / "dvi.toml").string());
  if (plan.program != program_fingerprint())
    throw InputError(out, fmt::format("was planned by another build of dvi (version {})", plan.version),
                     "use the same program on all machines, or " + again);
  if (plan.listing != listing_of(drives) || (!content.empty() && plan.content != content))
    throw InputError(out, "was planned from other files: the drive has changed since then", again);
  if (plan.fingerprint != fingerprint_of(job, plan.content))
    throw InputError(out / "dvi.toml", "was changed since the plan", again);
}

void write_cost(const fs::path& out, const std::string& name, const std::string& fingerprint, const CostReport& cost) {
  make_folder(costs_folder(out));
  write_manifest(costs_folder(out) / (name + ".json"), fingerprint, cost);
}

CostReport sum_costs(const fs::path& out, const std::string& fingerprint) {
  CostReport sum;
  if (!fs::is_directory(costs_folder(out))) return sum;
  for (const fs::path& file : list_files(costs_folder(out), {".json"}))
    if (const std::optional<Manifest> kept = read_manifest(file); kept && kept->content && kept->fingerprint == fingerprint)
      sum += kept->content->get<CostReport>();
  return sum;
}

}  // namespace dvi::result
