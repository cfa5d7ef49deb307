# docker build -t facies .
# Built in two stages, the program and the packages of its clients; run in another without a compiler, without root and
# without writing to its own files.
FROM rust:1.95-slim-bookworm AS build
# hadolint ignore=DL3008
RUN apt-get update \
    && apt-get install --yes --no-install-recommends ca-certificates gcc libc6-dev \
    && rm -rf /var/lib/apt/lists/*
WORKDIR /build
COPY Cargo.toml Cargo.lock ./
COPY src src
COPY docs/errors.md docs/errors.md
COPY mechanics mechanics
COPY benches benches
COPY migrations migrations
COPY web/dist web/dist
RUN --mount=type=cache,target=/usr/local/cargo/registry --mount=type=cache,target=/build/target \
    cargo build --release --locked && cp target/release/facies /usr/local/bin/facies

FROM node:22-bookworm-slim AS clients
# hadolint ignore=DL3008
RUN apt-get update \
    && apt-get install --yes --no-install-recommends ca-certificates python3 python3-venv \
    && rm -rf /var/lib/apt/lists/*
WORKDIR /build
COPY openapi openapi
COPY clients clients
RUN clients/build

FROM debian:bookworm-slim
COPY --from=build /etc/ssl/certs/ca-certificates.crt /etc/ssl/certs/ca-certificates.crt
COPY --from=build /usr/local/bin/facies /usr/local/bin/facies
COPY --from=clients /build/target/clients /usr/local/share/facies/clients
RUN useradd --system --uid 10001 --home-dir /data --shell /usr/sbin/nologin facies \
    && mkdir /data && chown facies /data
# By its number, so that a cluster can tell that it is not root.
USER 10001
# The only place that is written to: temporary files and, unless they have another place, database and blobs.
VOLUME /data
EXPOSE 8080 9090
# Outside a container the service binds to 127.0.0.1 alone; another address needs a key (FACIES_API_KEY).
ENV FACIES_BIND=0.0.0.0:8080 FACIES_DATA=/data FACIES_CLIENTS_FOLDER=/usr/local/share/facies/clients
HEALTHCHECK --interval=10s --timeout=3s --start-period=10s CMD ["facies", "health"]
ENTRYPOINT ["facies"]
CMD ["serve"]
