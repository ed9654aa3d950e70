# granchain's dashboard, for this machine only:
#     docker build -t granchain . && docker run --rm -p 127.0.0.1:5006:5006 granchain
#
# Numba compiles for the CPU model it runs on and puts that model into the names of its cache files. The cache in the
# image is therefore used on machines with the builder's CPU model. On any other machine, the kernels are compiled at the
# first visit (seconds, once per container) into the same folder, which the container's user can write to. Build on the
# CPU model that you run on, or keep the folder in a volume:  -v granchain-kernels:/opt/granchain/kernels

# The base image is python:3.13-slim of September 2026 (Python 3.13.15, Debian 13.6), pinned for all its platforms by the
# digest of its index. Debian's security fixes need a newer base image:
# `docker buildx imagetools inspect python:3.13-slim` shows its digest.
ARG BASE=python:3.13-slim@sha256:9d2e5553305c7c7b0097999bb17187c69b921ccd6bc9d40e4bb5ebe652c00285

FROM ${BASE} AS build

ENV PIP_NO_CACHE_DIR=1 PIP_DISABLE_PIP_VERSION_CHECK=1
RUN python -m venv /opt/granchain/venv
ENV PATH=/opt/granchain/venv/bin:$PATH

WORKDIR /opt/granchain/source
COPY pyproject.toml hatch_build.py requirements.lock requirements-build.lock README.md LICENSE ./
COPY granchain ./granchain
COPY granchain_core ./granchain_core
COPY granchain_start ./granchain_start
COPY app ./app
COPY assets ./assets
COPY docs/glossary.md ./docs/
RUN pip install --require-hashes -r requirements.lock
# Built without isolation, because pip would fetch hatchling without a hash, and in an environment left out of the image.
RUN python -m venv /opt/granchain/build && \
    /opt/granchain/build/bin/pip install --require-hashes -r requirements-build.lock && \
    /opt/granchain/build/bin/pip wheel --no-deps --no-build-isolation --wheel-dir /opt/granchain/wheel . && \
    pip install --no-deps /opt/granchain/wheel/*.whl

# Work in another folder, so that the kernels are compiled from the installed package, not from the source tree.
WORKDIR /opt/granchain
ENV GRANCHAIN_CACHE=/opt/granchain/kernels
RUN granchain warm


FROM ${BASE}

RUN useradd --create-home --uid 10001 granchain
COPY --from=build /opt/granchain/venv /opt/granchain/venv
COPY --from=build --chown=granchain:granchain /opt/granchain/kernels /opt/granchain/kernels

ENV PATH=/opt/granchain/venv/bin:$PATH \
    GRANCHAIN_CACHE=/opt/granchain/kernels \
    PYTHONUNBUFFERED=1
USER granchain
WORKDIR /home/granchain
EXPOSE 5006

HEALTHCHECK --interval=10s --timeout=5s --start-period=30s --retries=3 \
    CMD ["python", "-c", "import urllib.request; urllib.request.urlopen('http://127.0.0.1:5006/liveness', timeout=4)"]

# Browsers may reach the dashboard as localhost. For another name, add --allow-websocket-origin NAME:PORT to the run
# command, and --secret-file FILE, which then takes precedence over --generate-secret (docs/deployment.md). The health
# check uses port 5006, so choose a different outside port with -p.
# Nothing is written outside /tmp and the kernel folder, so the container can run read-only:
#     docker run --rm -p 127.0.0.1:5006:5006 --read-only --tmpfs /tmp --cap-drop ALL --security-opt no-new-privileges granchain
ENTRYPOINT ["granchain", "serve", "--address", "0.0.0.0", "--port", "5006", "--generate-secret", \
            "--allow-websocket-origin", "localhost:5006", "--allow-websocket-origin", "127.0.0.1:5006"]
