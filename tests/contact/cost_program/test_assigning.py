"""Variables, entries and containers are set as in Python, and the state never."""

import pytest

SAME = {
    "dict of lists": "d = {'a': []}\nd['a'].append(self.time)\nd['a'].append(2.0)\nreturn d['a'][0] + d['a'][1]",
    "helper that fills a dict": (
        "terms = {}\ndef add(name, x):\n    terms[name] = x\n    return x\n"
        "total = add('a', self.time) + 2.0 * add('b', 3.0)\nreturn total + sum(terms.values())"
    ),
    "list of lists": "L = [[1.0], [2.0]]\nL[0][0] = self.time\nL[1].append(3.0)\nreturn L[0][0] + len(L[1])",
    "list plus array": "L = [1.0, 2.0]\nL += np.array([3.0, 4.0])\nreturn len(L) + L[1]",
    "list plus tuple": "L = [1.0, 2.0]\nL += (3.0, 4.0)\nreturn len(L) + L[2]",
    "list extended by an array": "L = [self.time]\nL.extend(2.0 * self.ee_pos)\nreturn sum(L) + len(L)",
    "dict updated": "d = {'a': 1.0}\nd.update({'a': self.time, 'b': 2.0})\nd.update(c=3.0)\nreturn sum(d.values())",
    "chain of targets": "a = b = self.time\na += 1.0\nreturn a + 10.0 * b",
    "nested targets": "(a, (b, c)), d = (1.0, (self.time, 3.0)), 4.0\nreturn a + 10.0 * b + 100.0 * c + 1000.0 * d",
    "swap": "a, b = 1.0, self.time\na, b = b, a\nreturn a + 10.0 * b",
}
REFUSED = {
    "attribute of the state": ("self.time = 0.0\nreturn 1.0", "not_allowed", "the state cannot be changed"),
    "entry of the state": ("self.ee_pos[0] = 0.0\nreturn 1.0", "not_allowed", "the state cannot be changed"),
    "attribute in place": ("self.ee_pos += 1.0\nreturn 1.0", "not_allowed", "a variable of your own"),
    "sum that does not begin": ("cost += 1.0\nreturn cost", "unset", "begin with cost = 0.0"),
    "append to a tuple": ("t = (1.0,)\nt.append(2.0)\nreturn t[0]", "wrong_type", "a tuple of 1 cannot be changed"),
    "append to a dict": ("d = {}\nd.append(2.0)\nreturn 1.0", "wrong_call", "append does not apply to a dict"),
    "too few values": ("a, b = [self.time]\nreturn a", "wrong_size", "2 names cannot take 1 values"),
    "list of the caller in a branch": (
        "L = []\ndef add(x):\n    L.append(x)\n    return x\nreturn add(1.0) if self.time > 0.5 else 0.0",
        "shared",
        "cannot be changed inside a condition",
    ),
}


@pytest.mark.parametrize("case", sorted(SAME))
def test_an_assignment_gives_what_python_gives(case, agrees):
    agrees(SAME[case])


@pytest.mark.parametrize("case", sorted(REFUSED))
def test_an_assignment_that_cannot_be_made_is_refused(case, refusal):
    body, code, words = REFUSED[case]
    found = refusal(body)
    assert (found.code, words in found.text) == (code, True), found
