#include <fcntl.h>
#include <unistd.h>

#include "tools/gusset/cli.h"

namespace {

// A run's log would take the number of a stream that was closed (2>&-), and what is meant for the
// stream would land in it.
void OpenClosedStreams() {
  int fd = 0;
  do fd = open("/dev/null", O_RDWR);
  while (fd >= 0 && fd <= STDERR_FILENO);
  if (fd >= 0) close(fd);
}

}  // namespace

int main(int argc, char** argv) {
  OpenClosedStreams();
  return gusset::RunCommandLine(argc, argv);
}
