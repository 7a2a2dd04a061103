# What `coral reef sail` needs, for a surface computer or as a BlueOS extension: docs/reference/vehicle.md.
FROM python:3.11 AS build
WORKDIR /source
COPY pyproject.toml constraints.txt README.md LICENSE ./
COPY src src
COPY .ci .ci
RUN python -m venv /opt/coral \
    && sed -n '/^pip==/,/[^\\]$/p' constraints.txt >/tmp/pip.txt && /opt/coral/bin/pip install --requirement /tmp/pip.txt \
    && python .ci/requirements.py vehicle vision >/tmp/requirements.txt \
    && /opt/coral/bin/pip install --no-cache-dir --constraint constraints.txt --requirement /tmp/requirements.txt hatchling \
    && /opt/coral/bin/pip install --no-deps --no-build-isolation .

FROM python:3.11-slim
COPY --from=build /opt/coral /opt/coral
COPY blueos /srv/coral
# Compiled kernels fit one processor only: they are compiled at the first start, and stay apart from the surveys,
# whose folder others may write.
ENV PATH=/opt/coral/bin:$PATH \
    NUMBA_CACHE_DIR=/var/cache/coral \
    OPENBLAS_NUM_THREADS=1 \
    OMP_NUM_THREADS=1
WORKDIR /surveys
EXPOSE 9177/tcp

ARG AUTHOR="The CORAL authors"
ARG EMAIL="coral@example.org"
ARG SOURCE="https://example.org/coral"

LABEL org.opencontainers.image.title="CORAL"
LABEL version="0.2.0"
LABEL type="tool"
LABEL requirements="core >= 1.1"
LABEL tags='["navigation", "survey", "autonomy"]'
LABEL permissions='{\
  "ExposedPorts": {"9177/tcp": {}},\
  "HostConfig": {\
    "NetworkMode": "host",\
    "CapAdd": ["SYS_NICE"],\
    "Binds": ["/usr/blueos/extensions/coral:/surveys", "/usr/blueos/extensions/coral-cache:/var/cache/coral"]\
  }\
}'
LABEL authors="[{\"name\": \"$AUTHOR\", \"email\": \"$EMAIL\"}]"
LABEL company="{\"about\": \"Reef surveys by an underwater robot\", \"name\": \"$AUTHOR\", \"email\": \"$EMAIL\"}"
LABEL readme="$SOURCE/raw/{tag}/README.md"
LABEL links="{\"website\": \"$SOURCE\", \"support\": \"$SOURCE/issues\"}"

# Only the extension's page starts by itself. A survey is a person's command: nothing arms because a vehicle booted.
CMD ["python", "-m", "http.server", "9177", "--directory", "/srv/coral"]
