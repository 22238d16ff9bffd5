#pragma once

#include <unistd.h>

#include <fstream>

namespace thalweg::test {

/// [MB] Memory of this process that is in RAM.
inline double ResidentMegabytes() {
  std::ifstream statm("/proc/self/statm");
  long total = 0;
  long resident = 0;
  statm >> total >> resident;
  return static_cast<double>(resident * sysconf(_SC_PAGESIZE)) * 1e-6;
}

}  // namespace thalweg::test
