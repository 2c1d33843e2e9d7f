# nix-build packaging/nix, or with other packages: nix-build packaging/nix --arg pkgs 'import <nixpkgs> { }'
{ pkgs ? import <nixpkgs> { } }:

let
  # nixpkgs has no package of these headers.
  random123 = builtins.fetchGit {
    url = "https://github.com/DEShawResearch/random123.git";
    ref = "refs/tags/v1.14.0";
    rev = "726a093cd9a73f3ec3c8d7a70ff10ed8efec8d13";
  };
in
pkgs.stdenv.mkDerivation {
  pname = "gridlock";
  version = "0.2.0";
  src = pkgs.lib.cleanSource ../..;

  nativeBuildInputs = with pkgs; [
    cmake
    ninja
    pkg-config
    makeWrapper
  ];
  # The library is static, so programs that link it need these as well.
  propagatedBuildInputs = with pkgs; [
    fmt
    tomlplusplus
    nlohmann_json
    cli11
    xxhash
    onetbb
    cairo
    hdf5
    libdeflate
    zlib
    eigen
    libhwy
  ];
  cmakeFlags = [
    "-DGRIDLOCK_MPI=OFF"
    "-DGRIDLOCK_VIEW=OFF"
    "-DGRIDLOCK_BUILD_TESTS=OFF"
    "-DGRIDLOCK_BUILD_BENCHMARKS=OFF"
    "-DGRIDLOCK_UNITY_BUILD=ON"
    "-DRANDOM123_INCLUDE_DIR=${random123}/include"
  ];
  # Movies have the same letters everywhere.
  postInstall = ''
    wrapProgram $out/bin/gridlock \
      --set FONTCONFIG_FILE ${pkgs.makeFontsConf { fontDirectories = [ pkgs.dejavu_fonts ]; }}
  '';
  doInstallCheck = true;
  installCheckPhase = ''
    $out/bin/gridlock --version
  '';

  meta = {
    description = "Simulator of many agents that interact only with near neighbours";
    homepage = "https://gridlock.example.org";
    license = pkgs.lib.licenses.mit;
    platforms = pkgs.lib.platforms.linux;
    mainProgram = "gridlock";
  };
}
