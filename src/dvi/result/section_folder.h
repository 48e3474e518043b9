#pragma once

#include <cstddef>
#include <string>

#include "dvi/core/files.h"

namespace dvi::result {

/// Returns the folder of a section's plan, OUT/.dvi/sections/COUNT/NUMBER, which has the layout of a result without frames.
fs::path section_folder(const fs::path& out, std::size_t number, std::size_t count);

/// Returns the file with the options of the whole drive in the folder of a section.
fs::path options_of_whole(const fs::path& section);

/// Whether OUT has files of any section.
bool has_sections(const fs::path& out);

/// Returns the number of sections of the only complete cut in OUT. Throws InputError that names the sections that are missing,
/// were planned by another program, or with other options than the first one.
std::size_t find_planned_sections(const fs::path& out);

/// Throws InputError if a section of this cut is missing, was planned by another program, or with other options.
void require_planned_sections(const fs::path& out, std::size_t count);

/// Returns a fingerprint of the contents of all input files, as content_of() the sections' plans.
std::string content_of_sections(const fs::path& out, std::size_t count);

}  // namespace dvi::result
