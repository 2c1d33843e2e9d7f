// Runs every file of the directories and files it is given through a fuzz target: the corpus as a test, with any
// compiler.

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size);

namespace {

std::size_t replay(std::filesystem::path const& path) {
  if (std::filesystem::is_directory(path)) {
    std::size_t files = 0;
    for (auto const& entry : std::filesystem::directory_iterator(path)) files += replay(entry.path());
    return files;
  }
  std::ifstream file(path, std::ios::binary);
  std::string const content{std::istreambuf_iterator<char>(file), {}};
  LLVMFuzzerTestOneInput(reinterpret_cast<std::uint8_t const*>(content.data()), content.size());
  return 1;
}

}  // namespace

int main(int argument_count, char** arguments) {
  std::size_t files = 0;
  for (int k = 1; k < argument_count; ++k) files += replay(arguments[k]);
  std::printf("%zu inputs\n", files);
  return files > 0 ? 0 : 1;
}
