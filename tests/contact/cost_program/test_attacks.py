"""Programs that try to get out, to hang, to swell or to lie: every one is refused, or gives nothing but a number."""

from __future__ import annotations

import ast
import os
import textwrap

import numpy as np
import pytest

from coral.contact.cost_program import CostError, CostProgram


def body(code):
    return "def state_cost(self):\n" + textwrap.indent(textwrap.dedent(code).strip("\n"), "    ") + "\n"


WALK = "().__class__.__bases__[0].__subclasses__()"
REFUSED = {
    # reaching Python's own objects
    "subclass walk": body(f"return len({WALK})"),
    "class of self": body("return self.__class__.__name__"),
    "globals of a function": body("def f(): return 1\nreturn f.__globals__['os']"),
    "code of a function": body("f = lambda: 1\nreturn f.__code__.co_consts"),
    "closure of a builtin": body("return max.__self__.eval('1')"),
    "getattr with a joined name": body("return getattr(self, '__cl' + 'ass__')"),
    "getattr with a variable name": body("n = '__class__'\nreturn getattr(self, n)"),
    "getattr with a dunder": body("return getattr(self, '__dict__')"),
    "getattr of a module": body("return getattr(np, 'load')('/etc/passwd')"),
    "getattr of a vector": body("return getattr(self.ee_pos, 'items')"),
    "hasattr of a number": body("return 1.0 if hasattr(self.time, 'tofile') else 0.0"),
    "getattr kept in a variable": body("g = getattr\nreturn g(self, '__class__')"),
    "wide letters": body("return self.__ｃlass__"),
    "wide letters in getattr": body("return getattr(self, '__ｃlass__')"),
    "vars": body("return vars(self)"),
    "dir": body("return len(dir(self))"),
    "type": body("return type(self)"),
    "type call": body("return type('X', (), {})"),
    "object": body("return object()"),
    "globals": body("return globals()['CostProgram']"),
    "locals": body("return locals()"),
    "builtins": body("return __builtins__['open']"),
    "setattr": body("setattr(self, 'time', 0.0)\nreturn 1.0"),
    "items of a vector": body("return self.ee_pos.items[0]"),
    "base of a vector": body("return self.ee_pos[:2].base"),
    "data of an array": body("return self.time.data"),
    "ctypes of an array": body("return self.time.ctypes.data"),
    "frame of a generator": body("g = (x for x in [1])\nreturn g.gi_frame.f_back.f_globals"),
    "traceback": body("try:\n    1 / 0\nexcept Exception as e:\n    return e.__traceback__.tb_frame"),
    "handler that runs": body(
        "try:\n    x = 1.0 / (self.time * 0.0)\nexcept Exception:\n    x = 1.0\nreturn min(x, 2.0)"
    ),
    "type of an exception": body("try:\n    pass\nexcept (lambda: 1).__globals__['x'] as e:\n    pass\nreturn 1.0"),
    "exception kept": body("try:\n    x = 1.0\nexcept Exception as e:\n    x = 2.0\nreturn e.args[0]"),
    "attributes of a rotation": "from scipy.spatial.transform import Rotation as R\n"
    + body("return R.from_quat([0, 0, 0, 1]).quat[0]"),
    "more of scipy": "from scipy.spatial.transform import Slerp\n" + body("return 1.0"),
    "scipy's files": "import scipy.io\n" + body("return scipy.io.loadmat('/etc/passwd')"),
    "base class of a type": body("return float.__base__"),
    "type of isinstance": body("return isinstance(self, np.ndarray.__class__)"),
    "call of a type": body("return np.ndarray((1, 2))"),
    "except star": body("try:\n    pass\nexcept* Exception as e:\n    return e"),
    "match on a class": body("match self:\n    case object(__class__=c):\n        return c"),
    # files, processes, network
    "import os": "import os\n" + body("return os.system('id')"),
    "import inside": body("import subprocess\nreturn subprocess.call('id')"),
    "import from": "from os import system\n" + body("return system('id')"),
    "import with an alias": "import os as np\n" + body("return np.getpid()"),
    "dotted import": "import numpy.ctypeslib as c\n" + body("return c.ctypes"),
    "relative import": "from . import x\n" + body("return x"),
    "numpy submodule": "from numpy import ctypeslib\n" + body("return ctypeslib.ctypes"),
    "call of import": body("return __import__('os').getpid()"),
    "open": body("return len(open('/etc/passwd').read())"),
    "eval": body("return eval('1')"),
    "exec": body("exec('x = 1')\nreturn 1.0"),
    "compile": body("return compile('1', '', 'eval')"),
    "input": body("return input()"),
    "print kept": body("f = print\nf(self.time)\nreturn 1.0"),
    "print as a value": body("return print(1.0)"),
    "print into a file": body("def f():\n    return 1.0\nprint(f(), file=self)\nreturn 1.0"),
    "walrus in a print": body("print(x := 5.0)\nreturn x"),
    "breakpoint": body("breakpoint()\nreturn 1.0"),
    "exit": body("exit()\nreturn 1.0"),
    "np.load": body("return np.load('/tmp/x.npy', allow_pickle=True)"),
    "np.save": body("np.save('/tmp/x', self.time)\nreturn 1.0"),
    "np.memmap": body("return np.memmap('/tmp/x', mode='w+', shape=9)"),
    "np.savetxt": body("np.savetxt('/tmp/x', self.ee_pos)\nreturn 1.0"),
    "tofile": body("self.ee_pos.tofile('/tmp/x')\nreturn 1.0"),
    "np.fromfile": body("return np.fromfile('/etc/passwd')[0]"),
    "np.ctypeslib": body("return np.ctypeslib.ctypes.CDLL(None)"),
    "np.lib": body("return np.lib.npyio.DataSource().open('/etc/passwd')"),
    "np.f2py": body("return np.f2py.compile('x')"),
    "math to its loader": body("return math.__loader__.load_module('os')"),
    "pybullet reset": body("p.resetSimulation()\nreturn 1.0"),
    "pybullet plugin": body("return p.loadPlugin('/tmp/x.so')"),
    # strings that run
    "format": body("return '{0.__class__}'.format(self)"),
    "format method kept": body("f = '{0}'.format\nreturn f(self)"),
    "format map": body("return '{x}'.format_map({'x': self})"),
    "percent format": body("return '%s' % self"),
    "f-string": body("return f'{self.__class__}'"),
    "f-string width": body("return len(f'{1:>1000000000}')"),
    "f-string of the state": body("return {f'{self.time}': 1.0}"),
    "f-string of self": body("return {f'{self}': 1.0}"),
    "f-string of a function": body("return {f'{np.exp}': 1.0}"),
    "f-string conversion": body("return {f'{1!r:>9}': 1.0}"),
    "f-string doubling": body("x = 'aaaaaaaaaa'\nfor i in range(60):\n    x = f'{x}{x}'\nreturn len(x)"),
    "text doubling": body("x = 'aaaaaaaaaa'\nfor i in range(60):\n    x = x + x\nreturn len(x)"),
    "bytes": body("return b'x' * 10 ** 9"),
    "text times number": body("return len('x' * 10 ** 9)"),
    # time
    "while true": body("while True:\n    pass\nreturn 1.0"),
    "while counting": body("i = 0\nwhile i < 10 ** 9:\n    i += 1\nreturn i"),
    "nested while": body(
        "i = 0\nwhile i < 60:\n    j = 0\n    while j < 60:\n        k = 0\n        while k < 60:\n"
        "            k += 1\n        j += 1\n    i += 1\nreturn i"
    ),
    "while on the state": body("x = self.time\nwhile x > 0.0:\n    x = x - 1e-9\nreturn x"),
    "map of a map": body(
        "f = lambda x: sum(map(lambda y: sum(map(lambda z: z, range(60))), range(60)))\nreturn sum(map(f, range(60)))"
    ),
    "map that recurs": body("f = lambda g: sum(map(g, [g]))\nreturn f(f)"),
    "huge arange": body("return np.sum(np.arange(10 ** 9))"),
    "tiny step of arange": body("return np.sum(np.arange(0.0, 1.0, 1e-12))"),
    "huge linspace": body("return np.sum(np.linspace(0.0, 1.0, 10 ** 9))"),
    "sorting much": body(
        "xs = [self.time * i for i in range(60)]\nfor i in range(60):\n    xs = sorted(xs + xs)\nreturn xs[0]"
    ),
    "huge range": body("return sum(i for i in range(10 ** 12))"),
    "nested loops": body(
        "s = 0.0\nfor i in range(60):\n    for j in range(60):\n        for k in range(60):\n"
        "            s += 1.0\nreturn s"
    ),
    "nested comprehension": body("return sum(a * b * c for a in range(60) for b in range(60) for c in range(60))"),
    "recursion": body("def f(x): return f(x)\nreturn f(1)"),
    "mutual recursion": body("def f(x): return g(x)\ndef g(x): return f(x)\nreturn f(1)"),
    "recursive lambda": body("f = lambda g, x: g(g, x)\nreturn f(f, 1)"),
    "exponential helpers": body(
        "f0 = lambda x: x + x\n"
        + "\n".join(
            f"f{i} = lambda x: f{i - 1}(x) + f{i - 1}(x) + f{i - 1}(x) + f{i - 1}(x) + f{i - 1}(x) + f{i - 1}(x) + "
            f"f{i - 1}(x)"
            for i in range(1, 7)
        )
        + "\nreturn f6(self.time)"
    ),
    "recursion on the state": body("def f(x):\n    return 1.0 if x < 0 else f(x - self.time)\nreturn f(1.0)"),
    "power tower": body("return 9 ** 9 ** 9"),
    "squaring in a loop": body("x = 3\nfor i in range(60):\n    x = x * x\nreturn x"),
    "big shift": body("return 1 << 10 ** 9"),
    "big literal": body("return " + "9" * 5000),
    "appending while looping": body("xs = [1.0]\nfor i in range(60):\n    xs += xs\nreturn sum(xs)"),
    # memory
    "list times number": body("return len([0] * 10 ** 10)"),
    "huge zeros": body("return np.zeros((60000, 60000))[0, 0]"),
    "huge ones": body("return np.sum(np.ones(10 ** 9))"),
    "huge eye": body("return np.eye(10 ** 6)[0, 0]"),
    "list doubling": body("a = [self.time]\nfor i in range(60):\n    a = [a, a]\nreturn a[0]"),
    "tuple doubling": body("a = (self.time,)\nfor i in range(60):\n    a = a + a\nreturn a[0]"),
    "dict doubling": body("d = {'a': self.time}\nfor i in range(60):\n    d = {'a': d, 'b': d}\nreturn 1.0"),
    "outer products": body("v = np.ones(500)\nm = np.outer(v, v)\nreturn m[0, 0]"),
    "many arrays": body(
        "s = self.time\nfor i in range(64):\n    for j in range(64):\n        s = s + self.time * 2.0\nreturn s"
    ),
    # definitions that run early
    "decorator": "@eval\n" + body("return 1.0"),
    "class body": "class A:\n    x = open('/etc/passwd')\n\ndef cost(self):\n    return A.x\n\ndef b(self):\n    pass",
    "default argument": "def state_cost(self, x=open('/etc/passwd')):\n    return 1.0",
    "top-level call": "x = open('/etc/passwd')\n" + body("return 1.0"),
    "metaclass": "class A(metaclass=print): pass\n" + body("class B(A): pass\nreturn 1.0"),
    "star arguments": "def state_cost(*self):\n    return 1.0",
    "async function": "async def state_cost(self):\n    return 1.0",
    "yield": body("yield 1.0"),
    # changing what others use
    "set an attribute": body("self.time = 0.0\nreturn 1.0"),
    "add to an attribute": body("self.ee_pos += 1.0\nreturn 1.0"),
    "entry of the state": body("self.ee_pos[0] = 1.0\nreturn 1.0"),
    "attribute of numpy": body("np.exp = max\nreturn 1.0"),
    "attribute in a loop": body("for self.time in [1.0]:\n    pass\nreturn 1.0"),
    "out argument": body("np.add(self.ee_pos, 1.0, out=self.ee_pos)\nreturn 1.0"),
    "out of exp": body("np.exp(self.time, out=self.time)\nreturn 1.0"),
    "fill": body("self.ee_pos.fill(0.0)\nreturn 1.0"),
    "global seed": body("np.random.seed(0)\nreturn np.random.rand()"),
    "seterr": body("np.seterr(all='raise')\nreturn 1.0"),
    "global": body("global x\nx = 1\nreturn 1.0"),
    "nonlocal": body("x = 1\ndef f():\n    nonlocal x\n    x = 2\nf()\nreturn x"),
    "delete": body("del self.time\nreturn 1.0"),
    "walrus in a branch": body("return 1.0 if (self.time > 0.5) and (x := 2.0) else 0.0"),
    # wrong values
    "nan": body("return float('inf') - float('inf')"),
    "infinity": body("return float('inf')"),
    "nan word": body("return float('nan')"),
    "text": body("return 'cheap'"),
    "None": body("return None"),
    "vector": body("return self.ee_pos"),
    "list": body("return [self.time]"),
    "function": body("return lambda: 1"),
    "generator": body("return (x for x in [1.0])"),
    "in place on a quantity": body("v = self.ee_pos\nv *= 0\nreturn v[0] + self.ee_pos[0]"),
    "entry of a quantity": body("v = self.ee_pos\nv[0] = 9.0\nreturn v[0] + self.ee_pos[0]"),
    "entry of a copy": body("v = self.ee_pos.copy()\nv[0] = 9.0\nreturn v[0] + self.ee_pos[0]"),
    "self": body("return self"),
    "module": body("return np"),
    "dict of texts": body("return {'a': 'b'}"),
    "dict of dicts": body("return {'a': {'b': 1.0}}"),
    "number as key": body("return {1: 1.0}"),
    "state as key": body("return {self.time: 1.0}"),
    "too many terms": body("return {" + ", ".join(f"'t{i}': 1.0" for i in range(200)) + "}"),
    "wrong entry": "def run(self):\n    return 1.0\ndef also(self):\n    return 2.0",
    "no code": "I cannot help with that.",
    "nothing": "",
}
HARMLESS = {
    "rebinding max": body("max = min\nreturn max(self.time, 0.5)"),
    "rebinding np": body("np = 3.0\nreturn np + self.time"),
    "rebinding self": body("t = self.time\nself = 3.0\nreturn t * self"),
    "code in a comment": body("return self.time  # __import__('os').system('id')"),
    "code in a text": body('\'__import__("os").system("id")\'\nreturn self.time'),
    "long sum": body("return " + "+".join(["self.time"] * 900)),
}


@pytest.mark.parametrize("attack", sorted(REFUSED))
def test_an_attack_is_refused_with_a_reason(attack, schema, states):
    state = states(np.random.default_rng(0), 20, 10)
    before = {name: state[name].copy() for name in state.names()}
    with pytest.raises(CostError) as caught:
        CostProgram(REFUSED[attack], schema)(state)
    assert caught.value.code not in ("internal", "deadline", "killed")
    assert all(np.array_equal(before[name], state[name]) for name in before)


@pytest.mark.parametrize("attempt", sorted(HARMLESS))
def test_a_harmless_attempt_changes_nothing_outside(attempt, schema, states):
    state = states(np.random.default_rng(0))
    before = {name: state[name].copy() for name in state.names()}
    first = sum(CostProgram(HARMLESS[attempt], schema).evaluate(state).values())
    again = sum(CostProgram(HARMLESS[attempt], schema).evaluate(state).values())
    assert np.array_equal(first, again)
    assert all(np.array_equal(before[name], state[name]) for name in before)


def test_there_are_enough_attacks():
    assert len(REFUSED) + len(HARMLESS) >= 60


def test_the_package_runs_no_text_as_python():
    folder = os.path.dirname(__import__("coral.contact.cost_program", fromlist=["x"]).__file__)
    for name in os.listdir(folder):
        if name.endswith(".py"):
            with open(os.path.join(folder, name)) as file:
                tree = ast.parse(file.read())
            called = {
                node.func.id
                for node in ast.walk(tree)
                if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)
            }
            assert not called & {"eval", "exec", "compile", "__import__"}, name
