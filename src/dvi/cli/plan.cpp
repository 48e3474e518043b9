#include <cstdio>
#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "dvi/cli/command.h"
#include "dvi/cli/job_options.h"
#include "dvi/cli/plan_text.h"
#include "dvi/core/error.h"
#include "dvi/core/threads.h"
#include "dvi/result/result_folder.h"
#include "dvi/run/run.h"

namespace dvi::cli {
namespace {

/// A section of `--section K/N`.
struct SectionChoice {
  std::size_t number = 0, count = 0;
};

SectionChoice parse_section(const std::string& text) {
  SectionChoice chosen;
  int read = 0;
  if (std::sscanf(text.c_str(), "%zu/%zu%n", &chosen.number, &chosen.count, &read) != 2 ||
      static_cast<std::size_t>(read) != text.size() || chosen.number < 1 || chosen.number > chosen.count)
    throw UsageError(fmt::format("--section {}: expected K/N, section K of N, such as 1/10", text));
  if (chosen.count < 2) throw UsageError("--section 1/1: a drive in one section is planned without --section");
  return chosen;
}

std::string brief_section(const run::PlanReport& plan, const SectionChoice& section, const std::string& out) {
  return fmt::format(
      "section {} of {} planned: {} frames, {} to {}\n"
      "  dvi join {}   when all sections are planned",
      section.number, section.count, plan.frames.size(), plan.frames.front(), plan.frames.back(), out);
}

}  // namespace

void add_plan(Program& program) {
  struct Arguments : RunArguments {
    std::string section;
  };
  const auto a = std::make_shared<Arguments>();
  Command command = program.command("plan", "Run the global stages: poses, masks, map, exposure, alignment; then fill, finish");
  a->add_to(command);
  command.option("--section", a->section, "K/N: plan section K of N only (docs/scale.md); dvi join OUT joins all sections");
  command.run(
      [a] {
        job::Job job = a->job("plan");
        std::optional<SectionChoice> section;
        if (!a->section.empty()) {
          section = parse_section(a->section);
          job.sections = static_cast<int>(section->count);
        }
        const ThreadLimit limit(a->common.threads);
        Progress progress(a->common.style());
        const run::PlanReport plan = section ? run::plan_section(job, section->number, progress) : run::plan(job, progress);
        progress.end();
        if (section && !a->common.json) {
          fmt::print("{}\n", brief_section(plan, *section, job.out));
          return;
        }
        fmt::print("{}\n", a->common.json ? json_of(plan) : brief_plan(plan, job.out));
      },
      [a] { return result::describe_progress(a->out); });
}

}  // namespace dvi::cli
