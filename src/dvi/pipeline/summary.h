#pragma once

#include <string>

namespace dvi::pipeline {

/// A few lines for a person from report.json: what was filled, from where, what was never seen, where to look.
std::string run_summary(const std::string& report_json, const std::string& out);

}  // namespace dvi::pipeline
