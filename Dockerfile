# Builds Gridlock in one stage and keeps the program alone in the next:
#
#   docker build -t gridlock .
#   docker run --rm -v "$PWD:/work" gridlock run scenes/paper.toml -o results/first
FROM debian:bookworm-slim AS build
# The version of a program names the commit, which git is asked for.
RUN apt-get update -qq && apt-get install -y -qq --no-install-recommends git ca-certificates
COPY . /source
WORKDIR /source
RUN ./dev package

FROM debian:bookworm-slim
COPY --from=build /source/build-program/*.deb /packages/
RUN apt-get update -qq \
 && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends /packages/*.deb ffmpeg \
 && rm -rf /packages /var/lib/apt/lists/*
WORKDIR /work
ENTRYPOINT ["gridlock"]
