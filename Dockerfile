# Built in one stage, run in another without compiler, shell tools or root.
FROM rust:1.95-slim-bookworm AS build
RUN apt-get update && apt-get install --yes --no-install-recommends gcc libc6-dev && rm -rf /var/lib/apt/lists/*
WORKDIR /build
COPY Cargo.toml Cargo.lock ./
COPY src src
COPY migrations migrations
COPY openapi openapi
RUN cargo build --release --locked

FROM debian:bookworm-slim
RUN useradd --system --uid 10001 --home-dir /data facies && mkdir /data && chown facies /data
COPY --from=build /build/target/release/facies /usr/local/bin/facies
USER facies
VOLUME /data
EXPOSE 8080
# Outside a container the service binds to 127.0.0.1 alone; another address needs a key (FACIES_API_KEY).
ENV FACIES_BIND=0.0.0.0:8080 FACIES_DATA=/data
HEALTHCHECK --interval=10s --timeout=3s --start-period=5s CMD ["facies", "health"]
ENTRYPOINT ["facies"]
CMD ["serve"]
