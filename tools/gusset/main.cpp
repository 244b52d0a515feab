#include "tools/gusset/cli.h"

int main(int argc, char** argv) { return gusset::RunCommandLine(argc, argv); }
