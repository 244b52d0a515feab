# Writes OUT: a header with one number for the contents of all files that FILES lists and for the text
# BUILD.
file(STRINGS ${FILES} files)
string(SHA256 sum "${BUILD}")
foreach(file IN LISTS files)
  file(SHA256 ${file} of_file)
  string(SHA256 sum "${sum} ${of_file}")
endforeach()
string(SUBSTRING ${sum} 0 16 sum)
file(WRITE ${OUT} "#pragma once\n\n#define GUSSET_START_SOURCES \"${sum}\"\n")
