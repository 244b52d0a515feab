#include <fcntl.h>
#include <unistd.h>

#include <csignal>

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

// Of a pipe that nobody reads any more and a file that may grow no further (ulimit -f) the call
// that writes is to tell, not a signal that kills.
void HearOfBrokenWrites() {
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

}  // namespace

int main(int argc, char** argv) {
  OpenClosedStreams();
  HearOfBrokenWrites();
  return gusset::RunCommandLine(argc, argv);
}
