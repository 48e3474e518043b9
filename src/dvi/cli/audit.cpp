#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "dvi/cli/command.h"
#include "dvi/commands/audit_result.h"
#include "dvi/core/error.h"
#include "dvi/core/threads.h"

namespace dvi::cli {

void add_audit(Program& program) {
  struct Arguments {
    std::string out, target, masks;
    std::vector<std::string> drives;
    Common common;
  };
  const auto a = std::make_shared<Arguments>();
  Command command = program.command("audit", "Check the provenance of a result: every copied pixel against its source frame");
  command.positional("OUT", a->out, "A result of dvi run");
  command.positional("DRIVE", a->target, "The drive it was made from");
  command.positional("SOURCE", a->drives, "The source drives it was made from, in the same order");
  command.option("--masks", a->masks, "What to remove, if different from OUT/dvi.toml: DIR, FILE, labels, found, or auto");
  a->common.add_to(command, true, false);
  command.run([a] {
    const ThreadLimit limit(a->common.threads);
    Progress progress(a->common.style());
    a->drives.insert(a->drives.begin(), a->target);
    const commands::AuditReport report = commands::audit_result(a->out, a->drives, a->masks, progress);
    fmt::print("{}\n", a->common.json ? report.json : report.text);
    if (!report.audit.passed()) throw InputError(a->out, "fails the audit", "see the report");
  });
}

}  // namespace dvi::cli
