#include "dvi/core/process_memory.h"

#include <sys/resource.h>
#include <unistd.h>

#include <fstream>

namespace dvi {

std::size_t resident_memory() {
  std::size_t all_pages = 0, resident_pages = 0;
  std::ifstream file("/proc/self/statm");
  if (!(file >> all_pages >> resident_pages)) return 0;
  return resident_pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

std::size_t peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::size_t>(usage.ru_maxrss) * 1024;
}

}  // namespace dvi
