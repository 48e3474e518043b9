#include "dvi/result/plan_record.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "dvi/core/error.h"
#include "dvi/core/json_text.h"
#include "dvi/result/fingerprints.h"
#include "dvi/result/run_report.h"

namespace dvi::result {
namespace {

constexpr const char* kSchema = "dvi-plan/1";

fs::path plan_file(const fs::path& out) { return out / ".dvi/plan.json"; }
fs::path costs_folder(const fs::path& out) { return out / ".dvi/costs"; }

}  // namespace

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PlanRecord, version, program, listing, content, fingerprint)

void write_plan_record(const fs::path& out, const PlanRecord& record) {
  nlohmann::json json = record;
  json["schema"] = kSchema;
  write_file(plan_file(out), json_text(json) + "\n");
}

PlanRecord read_plan_record(const fs::path& out) {
  if (!fs::is_regular_file(plan_file(out)) || !fs::is_regular_file(out / "dvi.toml"))
    throw InputError(out, "holds no plan", "dvi plan TARGET -o OUT makes one");
  try {
    const nlohmann::json json = nlohmann::json::parse(read_file(plan_file(out)));
    if (json.at("schema") == kSchema) return json.get<PlanRecord>();
  } catch (const nlohmann::json::exception&) {  // answered below
  }
  throw InputError(plan_file(out), "is damaged, or of another version", "make it again: dvi plan --config OUT/dvi.toml");
}

void require_plan_of(const fs::path& out, const job::Job& job, const inputs::Recordings& drives, const std::string& content) {
  const PlanRecord plan = read_plan_record(out);
  const std::string again = fmt::format("plan again: dvi plan --config {}", (out / "dvi.toml").string());
  if (plan.program != program_fingerprint())
    throw InputError(out, fmt::format("was planned by another build of dvi (version {})", plan.version),
                     "use the same program on all machines, or " + again);
  if (plan.listing != listing_of(drives) || (!content.empty() && plan.content != content))
    throw InputError(out, "was planned from other files: the drive has changed since", again);
  if (plan.fingerprint != fingerprint_of(job, plan.content))
    throw InputError(out / "dvi.toml", "was changed since the plan", again);
}

void keep_cost(const fs::path& out, const std::string& name, const std::string& fingerprint, const CostReport& cost) {
  make_folder(costs_folder(out));
  write_file(costs_folder(out) / (name + ".json"),
             json_text(nlohmann::json{{"schema", kSchema}, {"fingerprint", fingerprint}, {"cost", cost}}) + "\n");
}

CostReport kept_costs(const fs::path& out, const std::string& fingerprint) {
  CostReport sum;
  if (!fs::is_directory(costs_folder(out))) return sum;
  for (const fs::path& file : list_files(costs_folder(out), {".json"})) {
    const nlohmann::json json = nlohmann::json::parse(read_file(file), nullptr, false);
    if (json.is_object() && json.value("schema", "") == kSchema && json.value("fingerprint", "") == fingerprint)
      sum += json.at("cost").get<CostReport>();
  }
  return sum;
}

}  // namespace dvi::result
