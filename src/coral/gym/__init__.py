"""Gymnasium environments: `import coral.gym` registers `coral/reef-s1-v0`, `coral/pick-box-v0` and the others.

A wing. It needs `coral.view` to render tasks.
"""

from coral.gym.registration import register_environments

register_environments()
