# Homebrew takes a formula from a path only where HOMEBREW_DEVELOPER is set; the page of recipes has the command.
class Gridlock < Formula
  desc "Simulator of many agents that interact only with near neighbours"
  homepage "https://gridlock.example.org"
  url "https://gridlock.example.org/gridlock.git", tag: "v0.2.0"
  license "MIT"
  head "https://gridlock.example.org/gridlock.git", branch: "main"

  depends_on "cmake" => :build
  depends_on "ninja" => :build
  depends_on "pkgconf" => :build

  depends_on "cairo"
  depends_on "cli11"
  depends_on "eigen"
  depends_on "fmt"
  depends_on "hdf5"
  depends_on "highway"
  depends_on "libdeflate"
  depends_on :linux
  depends_on "nlohmann-json"
  depends_on "tbb"
  depends_on "tomlplusplus"
  depends_on "xxhash"
  depends_on "zlib-ng-compat"

  resource "random123" do
    url "https://github.com/DEShawResearch/random123.git",
        tag:      "v1.14.0",
        revision: "726a093cd9a73f3ec3c8d7a70ff10ed8efec8d13"
  end

  def install
    resource("random123").stage buildpath/"random123"
    arguments = %W[
      -DGRIDLOCK_MPI=OFF
      -DGRIDLOCK_VIEW=OFF
      -DGRIDLOCK_BUILD_TESTS=OFF
      -DGRIDLOCK_BUILD_BENCHMARKS=OFF
      -DGRIDLOCK_UNITY_BUILD=ON
      -DRANDOM123_INCLUDE_DIR=#{buildpath}/random123/include
    ]
    system "cmake", "-G", "Ninja", "-S", ".", "-B", "build", *arguments, *std_cmake_args
    system "cmake", "--build", "build"
    system "cmake", "--install", "build"
  end

  test do
    (testpath/"crystal.toml").write "disks.count = 100\nrun.steps = 10\n"
    system bin/"gridlock", "run", "crystal.toml", "-o", "results"
    assert_path_exists testpath/"results/summary.json"
  end
end
