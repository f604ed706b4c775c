// @ts-nocheck
// Printed by Python from percept_obs.checking.refusing, percept_obs.checking.spelling, percept_obs.checking.tokens, percept_obs.checking.notation, percept_obs.checking.words: change those, not this.
import { py, CannotRead, Token, UnexpectedCharacters, _terminal, key, lexed, sp } from "./python.js";

const py_add = py.add;
const py_all = py.all;
const py_any = py.any;
const py_bool = py.bool;
const py_bound = py.bound;
const py_compare = py.compare;
const py_constant = py.constant;
const py_del = py.del;
const py_dict = py.dict;
const py_difflib = py.difflib;
const py_enumerate = py.enumerate;
const py_eq = py.eq;
const py_every = py.every;
const py_gen = py.gen;
const py_hasattr = py.hasattr;
const py_iadd = py.iadd;
const py_in = py.in;
const py_int = py.int;
const py_is = py.is;
const py_isinstance = py.isinstance;
const py_item = py.item;
const py_iter = py.iter;
const py_key = py.key;
const py_len = py.len;
const py_list = py.list;
const py_map = py.map;
const py_max = py.max;
const py_methods_add = py.methods.add;
const py_methods_append = py.methods.append;
const py_methods_count = py.methods.count;
const py_methods_endswith = py.methods.endswith;
const py_methods_fromkeys = py.methods.fromkeys;
const py_methods_get = py.methods.get;
const py_methods_index = py.methods.index;
const py_methods_isalpha = py.methods.isalpha;
const py_methods_isascii = py.methods.isascii;
const py_methods_isdigit = py.methods.isdigit;
const py_methods_isspace = py.methods.isspace;
const py_methods_items = py.methods.items;
const py_methods_join = py.methods.join;
const py_methods_lower = py.methods.lower;
const py_methods_lstrip = py.methods.lstrip;
const py_methods_pop = py.methods.pop;
const py_methods_removeprefix = py.methods.removeprefix;
const py_methods_removesuffix = py.methods.removesuffix;
const py_methods_replace = py.methods.replace;
const py_methods_rstrip = py.methods.rstrip;
const py_methods_setdefault = py.methods.setdefault;
const py_methods_split = py.methods.split;
const py_methods_startswith = py.methods.startswith;
const py_methods_strip = py.methods.strip;
const py_methods_values = py.methods.values;
const py_min = py.min;
const py_mul = py.mul;
const py_next = py.next;
const py_or = py.or;
const py_pairwise = py.pairwise;
const py_pattern = py.pattern;
const py_put = py.put;
const py_range = py.range;
const py_re = py.re;
const py_repr = py.repr;
const py_reversed = py.reversed;
const py_set_ = py.set_;
const py_slice = py.slice;
const py_some = py.some;
const py_sorted = py.sorted;
const py_str = py.str;
const py_sub = py.sub;
const py_sum = py.sum;
const py_t = py.t;
const py_unicodedata = py.unicodedata;
const py_zip = py.zip;
const CLOSING = new Map(Object.entries({ "RPAR": "(", "RBRACE": "{", "RSQB": "[", "_BAR_CLOSE": "|", "_NORM_CLOSE": "||", "_END_MATRIX": "\\begin", "_END_CASES": "\\begin" }));
function two_meanings(readings, instead) {

return `this can be read as ${py_str(py_methods_join(" or as ", readings))}; ${py_str(instead)}`;
}

function about_character(c) {
let name;

name = py_unicodedata.name(c, "a control character");
if (py_eq(c, "_")) {
return "an index is letters and digits, as in y_1 or v_{c1}";
}
if (py_methods_isalpha(c)) {
return `${py_repr(c)} is ${py_str(name)}; letters are Latin or Greek, so type the letter that it looks like`;
}
return `${py_repr(c)} (${py_str(py_methods_lower(name))}) has no meaning in a formula; there are letters, numbers and + - * / ^ ( ) =`;
}

function about_command(name) {

if (py_in(name, ["hat", "bar", "dot", "tilde", "widehat", "widetilde", "overline"])) {
return `\\${py_str(name)} stands over a letter, as in \\${py_str(name)}{y}_{1}`;
}
if (py_in(name, ["begin", "end"])) {
return "of LaTeX's environments matrices, arrays, cases and those of equations and lines are read";
}
return `\\${py_str(name)} is not read; there are \\frac, \\sqrt, \\sum with numbers, functions, Greek letters, matrices`;
}

function about_token(token, accepted) {
let end, open_brackets;

open_brackets = py_list(py_gen(accepted, (kind) => py_item(CLOSING, kind), (kind) => py_in(kind, CLOSING)));
if (py_compare(accepted, "<=", new Set(["LPAR", "LBRACE", "_POWER", "RAISED"]))) {
return "a function takes its argument in brackets, as in sin(...), and a command in braces";
}
if ((py_in("NAME", accepted) && !py_in("_TIMES", accepted))) {
end = py_eq(token.type, "$END");
return `${py_str((py_t(end) ? "the formula ends too early: " : ""))}a number, a letter or a bracket is expected here`;
}
if (py_in(token.type, ["_POWER", "RAISED"])) {
return "a power of a power needs brackets: (x^2)^3";
}
if (py_eq(token.type, "NUMBER")) {
return "a number after a factor can mean two things; write * or ^ before it";
}
if (py_t(open_brackets)) {
return `the bracket ${py_str(py_item(open_brackets, 0))} is not closed`;
}
if (py_in(token.type, CLOSING)) {
return "this bracket was never opened";
}
return "an operator or the end of the line is expected here";
}

const ACCENTS = new Map(Object.entries({ "\u0302": "hat", "\u0304": "bar", "\u0307": "dot", "\u0303": "tilde" }));
const _OVER = new Map(Object.entries({ "hat": "hat", "bar": "bar", "dot": "dot", "tilde": "tilde", "widehat": "hat", "widetilde": "tilde", "overline": "bar" }));
const REPLACED = py_constant('REPLACED', true);
const _RELATION = py_constant('_RELATION', false);
const _FORMULA = py_pattern("[+*/^=<>()\\[\\]{}&\\\\]|(^|\\s)-|-(\\s|$)|[\\d_']\\w*\\s+\\w*[\\d_']");
const _SIGN_ALONE = py_constant('_SIGN_ALONE', false);
const _WORD = py_pattern("(?<![\\w\\\\])[A-Za-z]{2,}(?!\\w)");
const _VERB = py_constant('_VERB', false);
const _SAID = py_pattern("\\\\(text|textrm|mbox|mathrm)\\s*\\{([^{}]*)\\}");
const _WORDS_OF_CASES = py_pattern("\\s*(for|if|when|otherwise|else)[,.]?\\s*|\\s*\\w+\\s*");
const _NAMED_BY_COLON = py_pattern("[\\s{]*[A-Za-z]\\w*(dot|')\\s*:(?!=)[^=<>]*");
function spelled(text) {
let pieces;

pieces = py_list(py_gen(text, (c) => _plain(c)));
return [py_methods_join("", pieces), py_list((function* () { for (const [k, piece] of py_iter(py_enumerate(pieces))) for (const _ of py_iter(piece)) yield k; })())];
}

function _plain(c) {
if ((py_in(c, REPLACED) || py_methods_isascii(c))) {
return py_methods_get(REPLACED, c, c);
}
if (py_methods_startswith(py_unicodedata.name(c, ""), "MATHEMATICAL")) {
c = py_unicodedata.normalize("NFKC", c);
}
return py_some(py_methods_get(REPLACED, c), () => py_methods_join("", py_gen(py_unicodedata.normalize("NFD", c), (d) => py_methods_get(REPLACED, d, d))));
}

function laid_out(text) {
let lines;

text = _delimited(text);
lines = py_list(py_gen(py_methods_split(py_re.sub("(?<!\\\\)\\\\\\n", "  ", text), "\n"), (line) => _line(line)));
return py_methods_join("\n", lines);
}

function _blank(text) {
return py_methods_join("", py_gen(text, (c) => (py_eq(c, "\n") ? c : " ")));
}

function _delimited(text) {
let between, end, inside, kept, kind, mark, marks, opened, out, related, start, whole;

inside = [];
opened = null;
marks = [];
for (mark of py_iter(_terminal("DELIMITER").finditer(text))) {
kind = py_methods_get(_PARTNER, py_item(mark, 0), (py_methods_startswith(py_item(mark, 0), "```") ? py_re.sub("[a-z]*$", "", py_item(mark, 0)) : py_item(mark, 0)));
if (py_eq(kind, "\\\\")) {
continue;
}
if ((!(py_methods_startswith(kind, "\\begin")) && !(py_methods_startswith(kind, "\\end")))) {
py_methods_append(marks, mark.span());
} else {
kind = py_re.sub("^\\\\end", "\\\\begin", kind);
}
if (py_is(opened, null)) {
opened = [mark.end(), kind];
} else {
if (py_eq(py_item(opened, 1), kind)) {
py_methods_append(inside, [py_item(opened, 0), mark.start()]);
opened = null;
}
}
}
between = _outside(text, inside);
whole = py_list(py_gen(inside, ([start, end]) => py_item(text, py_slice(start, end, null))));
for ([start, end] of py_iter(marks)) {
text = py_add(py_add(py_item(text, py_slice(null, start, null)), py_mul(" ", py_sub(end, start))), py_item(text, py_slice(end, null, null)));
}
if ((!(py_t(inside)) || py_any(py_gen(between, (part) => py_some(_RELATION.search(part), () => _SIGN_ALONE.fullmatch(part)))))) {
return text;
}
related = py_any(py_gen(whole, (part) => _RELATION.search(part)));
kept = py_list(py_gen(py_zip(inside, whole), ([span, part]) => span, ([span, part]) => (py_t(_RELATION.search(part)) || !(py_t(related)))));
out = py_list(_blank(text));
for ([start, end] of py_iter(kept)) {
py_put(out, py_slice(start, end, null), py_item(text, py_slice(start, end, null)));
if (py_t(start)) {
py_put(out, (start - 1), "\n");
}
if (py_compare(end, "<", py_len(out))) {
py_put(out, end, "\n");
}
}
return py_methods_join("", out);
}

const _PARTNER = new Map(Object.entries({ "\\]": "\\[", "\\)": "\\(" }));
function _outside(text, inside) {
let ends, starts;
ends = [0, ...py_iter(py_gen(inside, ([_, end]) => end))];
starts = [...py_iter(py_gen(inside, ([start, _]) => start)), py_len(text)];
return py_list(py_gen(py_zip(ends, starts), ([end, start]) => py_item(text, py_slice(end, start, null))));
}

function _line(line) {
let numbered, start, words;

line = _terminal("COMMENT").sub(((found) => py_mul(" ", py_len(py_item(found, 0)))), line);
line = py_re.sub("^\\s*>|^\\s*\\*\\*(?=\\S)|^\\s*__(?=\\S)|(?<=\\S)__\\s*$|(?<=\\S)\\*{1,3}\\s*$|^\\s*\\*(?=[A-Za-z\\\\])", ((f) => py_mul(" ", py_len(py_item(f, 0)))), line);
start = py_sub(py_len(line), py_len(py_methods_lstrip(line)));
if (py_t((numbered = _terminal("NUMBERED").match(line, start)))) {
line = py_add(py_mul(" ", numbered.end()), py_item(line, py_slice(numbered.end(), null, null)));
}
line = py_re.sub("(?<=\\s\\s|.,|ad)\\s*\\((\\d{1,2}[a-z]?)\\)\\s*[.,]?\\s*$", ((f) => py_mul(" ", py_len(py_item(f, 0)))), line);
line = py_re.sub("\\(((?:with|where)\\s.*)\\)(\\s*)$", " \\1 \\2", line);
if (py_t(_NAMED_BY_COLON.fullmatch(line))) {
line = py_methods_replace(line, ":", "=", 1);
if (py_methods_startswith(py_methods_lstrip(line), "{")) {
line = py_methods_removesuffix(py_methods_rstrip(py_methods_replace(line, "{", " ", 1)), "}");
}
}
line = _SAID.sub(_said, line);
words = py_re.split("(\\s+)", line);
line = py_methods_join("", py_gen(words, (word) => _without_stop(word)));
if ((!(py_t(_terminal("PROSE").search(line))) && !py_in("\n", line))) {
return line;
}
return py_methods_join("", _parted(line));
}

function* _parted(line) {
let _, after, end, found, part, says, start;

found = py_list(py_gen(_terminal("PROSE").finditer(line), (each) => [each.start(), each.end()]));
for ([[_, start], [end, after]] of py_iter(py_pairwise([[0, 0], ...py_iter(found), [py_len(line), py_len(line)]]))) {
part = py_item(line, py_slice(start, end, null));
says = py_some(!(py_t(py_re.search("[\\d_]", part))), () => py_re.search("(?<![\\w\\\\])[A-Za-z]{2,}(?!\\w)", part), () => _VERB.match(py_item(line, py_slice(end, null, null))));
yield ((py_t(says) && !(py_t(_FORMULA.search(part)))) ? _blank(part) : part);
yield py_add(py_mul("\n", py_compare(after, ">", end)), py_mul(" ", (py_sub(after, end) - 1)));
}
}

function _said(found) {
let head;

if ((py_t(_WORDS_OF_CASES.fullmatch(py_item(found, 2))) && !(py_t(_terminal("PROSE").search(py_item(found, 2)))))) {
return py_item(found, 0);
}
head = (py_methods_index(py_item(found, 0), "{") + 1);
return py_add(py_add(py_add("\n", py_mul(" ", (head - 1))), py_item(found, 2)), " ");
}

function _without_stop(word) {
let bare;

bare = py_methods_rstrip(word, ",");
if ((py_methods_endswith(bare, [".", "!", "?"]) && !(py_methods_isdigit(py_item(bare, py_slice(null, -1, null)))) && !(py_methods_endswith(bare, ["\\right.", "\\left."])))) {
return py_add(py_add(py_item(bare, py_slice(null, -1, null)), "\n"), py_item(word, py_slice(py_len(bare), null, null)));
}
if ((py_methods_endswith(bare, ":") && !(py_methods_endswith(bare, "\\:")))) {
return py_add(py_add(py_item(bare, py_slice(null, -1, null)), "\n"), py_item(word, py_slice(py_len(bare), null, null)));
}
return word;
}

function name_of(token) {
let accents, marks, over, plain, text;

marks = py_methods_join("", ACCENTS);
text = py_re.sub("\\s*\\^\\s*(\\{\\s*((\\\\prime\\s*)+)\\}|\\\\prime)", ((f) => py_mul("'", py_methods_count(py_item(f, 0), "prime"))), token);
text = py_re.sub("\\\\(mathbf|boldsymbol|bm|mathit|vec|mathcal|mathsf|pmb)(?![A-Za-z])", "", text);
text = py_re.sub("\\\\var(?=[a-zA-Z])", "\\\\", text);
over = py_re.findall(`\\\\(${py_str(py_methods_join("|", _OVER))})(?![A-Za-z])`, text);
accents = [...py_iter(py_gen(over, (each) => py_item(_OVER, each))), ...py_iter(py_gen(text, (c) => py_item(ACCENTS, c), (c) => py_in(c, ACCENTS)))];
plain = py_re.sub(`\\\\(${py_str(py_methods_join("|", _OVER))})(?![A-Za-z])|[${py_str(marks)}',]`, "", text);
return key(py_add(py_add(plain, py_methods_join("", accents)), py_mul("dot", py_methods_count(text, "'"))));
}

const _DEE = "(?:d|\u2202|\\\\partial|\\\\mathrm\\s*(?:\\{\\s*d\\s*\\}|d)|\\\\rm\\s)";
const _FRACTION = py_constant('_FRACTION', false);
const _CALLS = py_constant('_CALLS', false);
function rate_of(token) {
let by, found, inner, name;

if (py_t((found = _FRACTION.fullmatch(token)))) {
[inner, by] = py_list([py_item(found, 1), py_methods_strip(py_some(py_item(found, 2), () => py_item(found, 3)))]);
} else {
if (py_methods_startswith(token, "Symbol")) {
return name_of(py_item(py_methods_split(token, "'"), 1));
} else {
found = _CALLS.fullmatch(token);

[inner, by] = py_list([py_next(py_gen(found.groups(), (part) => part, (part) => py_t(part))), "t"]);
}
}
inner = (py_methods_startswith(py_methods_strip(inner), "(") ? py_methods_removesuffix(py_methods_removeprefix(py_methods_strip(inner), "("), ")") : inner);
name = name_of(py_methods_strip(py_re.sub("\\s*\\([^()]*\\)\\s*$", "", inner)));
return (py_eq(by, "t") ? key(`${py_str(name)}dot`) : `d${py_str(name)}`);
}

function other_names(name) {
let found, numbered, quotient;

numbered = py_re.sub("^(omega|wc?|vc|vp)([xyz])", ((f) => py_add(py_item(f, 1), py_str((py_methods_index("xyz", py_item(f, 2)) + 1)))), name);
found = [py_re.sub("^(lambda\\d?)hat", "\\1", name), numbered, py_re.sub("omega", "w", numbered)];
py_methods_append(found, py_re.sub("omega|^w(?!c)", "wc", numbered));
py_methods_append(found, py_re.sub("^(k\\d|xf|R|Omegag)bar$|^(xO)q$|^(I)n$", "\\1\\2\\3", name));
if (py_t((quotient = py_re.fullmatch("d(\\w+)dt", name)))) {
py_methods_append(found, key(`${py_str(py_item(quotient, 1))}dot`));
}
return py_list(py_gen(py_methods_fromkeys(py_dict, found), (each) => each, (each) => !py_eq(each, name)));
}

const FUNCTIONS = py_constant('FUNCTIONS', true);
const WRAPPERS = new Set("ImmutableMatrix Matrix array expand factor simplify".split(' '));
const OPENING = new Map(Object.entries({ "LPAR": "RPAR", "LBRACE": "RBRACE", "LSQB": "RSQB", "_BAR_OPEN": "_BAR_CLOSE", "_NORM_OPEN": "_NORM_CLOSE", "_MATRIX": "_END_MATRIX", "_CASES": "_END_CASES" }));
const AROUND = new Map(Object.entries({ "_MATRIX": "_END_MATRIX", "_CASES": "_END_CASES", "LBRACE": "RBRACE" }));
const SUMMAND_ENDS = new Set("COMMA END EQUAL MINUS PLUS RBRACE RELATION RPAR RSQB _BAR_CLOSE _CELL _END_CASES _END_MATRIX _LINE _NORM_CLOSE _ROW".split(' '));
function indexed(token, index, number) {

if (!py_eq(token.type, "NAME")) {
return token;
}
if (py_eq(token, index)) {
return token.update({ type: "NUMBER", value: number });
}
function put(found) {
return py_re.sub(`(?<![A-Za-z\\\\])${py_str(index)}(?![A-Za-z])|(?<=[ijklmn])${py_str(index)}|${py_str(index)}(?=[ijklmn])`, number, py_item(found, 0));
}

return token.update({ value: py_re.sub("_\\s*(\\{[^{}]*\\}|[A-Za-z0-9]+)", put, token) });
}

function systems(tokens) {
let branches, found, k, opened, token;

found = py_set_();
opened = [];
branches = py_set_();
for ([k, token] of py_iter(py_enumerate(tokens))) {
if (py_in(token.type, OPENING)) {
py_methods_append(opened, k);
} else {
if ((py_in(token.type, CLOSING) && py_t(opened))) {
py_methods_pop(opened);
} else {
if ((py_t(opened) && py_in(token.type, ["_FOR", "OTHERWISE"]))) {
py_methods_add(branches, py_item(opened, -1));
} else {
if ((py_t(opened) && py_eq(token.type, "EQUAL") && py_in(py_item(tokens, py_item(opened, -1)).type, AROUND))) {
py_methods_add(found, py_item(opened, -1));
}
}
}
}
}
return py_sub(found, branches);
}

function differential(tokens, k) {

if ((py_compare((k + 1), "<", py_len(tokens)) && (py_eq(py_item(tokens, k), "d") || py_t(py_re.fullmatch("\\\\mathrm\\s*\\{\\s*d\\s*\\}", py_item(tokens, k)))))) {
return (py_eq(py_item(tokens, (k + 1)).type, "NAME") ? 2 : 0);
}
return py_int(py_every(py_eq(py_item(tokens, k).type, "NAME"), () => py_bool(py_re.fullmatch("d(t|s|tau|sigma)", py_item(tokens, k)))));
}

function bullet(tokens, k) {
let apart, token;

token = py_item(tokens, k);
if ((!py_in(token.type, ["MINUS", "_TIMES"]) || (py_t(k) && !py_eq(py_item(tokens, (k - 1)).type, "_LINE")) || py_compare(py_len(tokens), "<", (k + 3)))) {
return false;
}
apart = py_compare(py_some(token.end_pos, () => 0), "<", py_some(py_item(tokens, (k + 1)).start_pos, () => 0));
return py_every(apart, () => py_eq(py_item(tokens, (k + 1)).type, "NAME"), () => py_eq(py_item(tokens, (k + 2)).type, "EQUAL"));
}

function* split(tokens) {
let depth, line, token;

line = [];
depth = 0;
for (token of py_iter(tokens)) {
depth = py_iadd(depth, py_sub(py_in(token.type, OPENING), py_in(token.type, CLOSING)));
if ((py_eq(token.type, "END") || (py_eq(depth, 0) && py_in(token.type, ["_LINE", "COMMA"])))) {
yield [line, token];
line = [];
} else {
py_methods_append(line, token);
}
}
}

function top_level(line, start, kind) {
let depth, k;

depth = 0;
for (k of py_iter(py_range(start, py_len(line)))) {
depth = py_iadd(depth, py_sub(py_in(py_item(line, k).type, OPENING), py_in(py_item(line, k).type, CLOSING)));
if ((py_eq(depth, 0) && py_eq(py_item(line, k).type, kind))) {
return k;
}
}
return null;
}

function partners(tokens) {
let found, k, opened, token;

opened = [];
found = new Map([]);
for ([k, token] of py_iter(py_enumerate(tokens))) {
if (py_in(token.type, OPENING)) {
py_methods_append(opened, k);
} else {
if ((py_in(token.type, CLOSING) && py_t(opened))) {
py_put(found, py_methods_pop(opened), k);
}
}
}
return found;
}

function exponent_end(tokens, partner, k) {

if (py_eq(py_item(tokens, k).type, "RAISED")) {
return (k + 1);
}
if (!py_eq(py_item(tokens, k).type, "_POWER")) {
return k;
}
k = py_iadd(k, py_add(1, py_eq(py_item(tokens, (k + 1)).type, "MINUS")));
return py_min((py_methods_get(partner, k, k) + 1), (py_len(tokens) - 1));
}

function unit_end(tokens, partner, k) {
let _, braces, number;

number = py_eq(py_item(tokens, k).type, "NUMBER");
k = py_iadd(k, number);
braces = py_methods_get(new Map([["_FRACTION", 2], ["_ROOT", 1]]), py_item(tokens, k).type, 0);
if ((py_in(py_item(tokens, k).type, ["_BAR_OPEN", "_NORM_OPEN"]) && py_in(k, partner))) {
k = (py_item(partner, k) + 1);
} else {
if ((py_in(py_item(tokens, k).type, ["NAME", "PI"]) || py_t(braces))) {
k = py_iadd(k, 1);
for (_ of py_iter(py_range(braces))) {
if (!py_in(k, partner)) {
return null;
}
k = (py_item(partner, k) + 1);
}
} else {
if (!(py_t(number))) {
return null;
}
}
}
return exponent_end(tokens, partner, k);
}

const LONGEST = 9000;
const LONGEST_NUMBER = 15;
const LONGEST_WORD = 60;
const DEEPEST = 40;
const MOST_INTEGRALS = 20;
const _TOO_LONG = new Map(Object.entries({ "'{9}": "more than 8 primes stand here", "[A-Za-z0-9_\\u0302-\\u0307]{240}": "a word has more than 60 letters" }));
const _OPERAND_ENDS = new Set("NAME NUMBER PI RAISED RBRACE RPAR RSQB _BAR_CLOSE _END_MATRIX _NORM_CLOSE".split(' '));
const _OPERAND_STARTS = new Set("EULER LBRACE LPAR LSQB NAME NUMBER PI RAISED SLASH _FRACTION _ROOT".split(' '));
class Notation {
 constructor(text, letters, labels, functions) {
let found, pattern, what;
const self = this;
[self.text, self.letters, self.labels, self.functions] = py_list([text, letters, py_set_(labels), functions]);
self.known = new Set([...py_iter(letters), ...py_iter(self.labels)]);
if (py_compare(py_len(text), ">", LONGEST)) {
throw new CannotRead(text, LONGEST, `the formula has ${py_str(py_len(text))} characters; at most ${py_str(LONGEST)}`);
}
[self.plain, self.origin] = py_list(spelled(text));
for ([pattern, what] of py_iter(py_methods_items(_TOO_LONG))) {
if (py_t((found = py_re.search(pattern, self.plain)))) {
self.refuse(`${py_str(what)}; write * between letters`, found.start());
}
}
self.bound = new Map([]);
}
 refuse(message, at = null) {
let position, start;
const self = this;

start = (py_isinstance(at, Token) ? at.start_pos : (py_hasattr(at, "meta") ? at.meta.start_pos : at));
position = ((!py_is(start, null) && py_compare(start, "<", py_len(self.origin))) ? py_item(self.origin, start) : py_len(self.text));
throw new CannotRead(self.text, position, message);
}
 _raw() {
let position, raw;
const self = this;
try {
raw = [...py_iter(lexed(laid_out(self.plain))), new Token("END", "", py_len(self.plain), { end_pos: py_len(self.plain) })];
} catch (error_) {
if (!(error_ instanceof UnexpectedCharacters)) throw error_;
let error = error_;position = py_item(self.origin, py_some(error.pos_in_stream, () => 0));
throw new CannotRead(self.text, position, about_character(py_item(self.text, position)));
}
return raw;
}
 _sums(tokens) {
let at, depth, end, first, index, k, last, out, start, summand, term, terms;
const self = this;

for (start of py_iter(py_range((py_len(tokens) - 1), -1, -1))) {
if (!py_eq(py_item(tokens, start).type, "SUM")) {
continue;
}
[index, first, last] = py_list(py_re.findall("(?<=[{\\s])[A-Za-z](?=\\s*=)|\\d", py_item(tokens, start)));
[end, depth] = py_list([(start + 1), 0]);
while ((py_t(depth) || !py_in(py_item(tokens, end).type, SUMMAND_ENDS) || py_eq(end, (start + 1)))) {
depth = py_iadd(depth, py_sub(py_in(py_item(tokens, end).type, OPENING), py_in(py_item(tokens, end).type, CLOSING)));
if ((py_compare(depth, "<", 0) || py_eq(py_item(tokens, end).type, "END"))) {
break;
}
end = py_iadd(end, 1);
}
[summand, at] = py_list([py_item(tokens, py_slice((start + 1), end, null)), py_item(tokens, start)]);
terms = py_list(py_gen(py_range(py_int(first), (py_int(last) + 1)), (k) => py_list(py_gen(summand, (t) => indexed(t, index, py_str(k))))));
out = [at.update({ type: "LPAR", value: "(" })];
for ([k, term] of py_iter(py_enumerate(terms))) {
out = py_iadd(out, py_add(py_mul([at.update({ type: "PLUS", value: "+" })], py_bool(k)), term));
}
tokens = [...py_iter(py_item(tokens, py_slice(null, start, null))), ...py_iter(out), at.update({ type: "RPAR", value: ")" }), ...py_iter(py_item(tokens, py_slice(end, null, null)))];
if ((!(py_t(terms)) || py_compare(py_len(tokens), ">", LONGEST))) {
self.refuse("this sum has too many terms, or none", at);
}
}
return tokens;
}
 _numbers(tokens) {
let call, e, exponent, letter, mantissa, opened, out, token, told;
const self = this;

out = [];
opened = [];
for (token of py_iter(tokens)) {
if (py_in(token.type, OPENING)) {
call = py_every(py_eq(token.type, "LPAR"), () => out, () => py_in(py_item(out, -1), self.functions));
py_methods_append(opened, (py_t(call) ? "LSQB" : token.type));
} else {
if ((py_in(token.type, CLOSING) && py_t(opened))) {
py_methods_pop(opened);
}
}
if (py_compare(py_len(opened), ">", DEEPEST)) {
self.refuse(`brackets are nested more than ${py_str(DEEPEST)} deep; write the formula flatter`, token);
}
if ((py_in(token.type, ["NUMBER", "DECIMAL"]) && py_compare(py_len(token), ">", LONGEST_NUMBER))) {
self.refuse(`numbers have at most ${py_str(LONGEST_NUMBER)} digits`, token);
}
if (py_eq(token.type, "TRANSPOSE")) {
out = py_iadd(out, [token.update({ type: "_POWER", value: "^" }), token.update({ type: "NAME", value: "T" })]);
} else {
if (py_eq(token.type, "DECIMAL")) {
out = py_iadd(out, self._decimal(token, py_every(py_bool(opened), () => py_eq(py_item(opened, -1), "LSQB"))));
} else {
if ((py_eq(token.type, "NUMBER") && py_t((e = py_re.search("[eE]", token))))) {
[mantissa, exponent] = py_list([py_item(token, py_slice(null, e.start(), null)), py_item(token, py_slice(e.end(), null, null))]);
letter = (py_methods_isdigit(exponent) ? key(py_item(token, py_slice(e.start(), null, null))) : py_item(token, e.start()));
if (py_in(letter, self.known)) {
told = [`${py_str(mantissa)} times ten to the power of ${py_str(exponent)}`, `${py_str(mantissa)} times ${py_str(py_item(token, py_slice(e.start(), null, null)))}`];
self.refuse(two_meanings(told, "write * between, or 10^"), token);
}
if (py_compare(py_len(py_methods_lstrip(exponent, "+-")), ">", 2)) {
self.refuse("exponents of ten have at most two digits", token);
}
py_methods_append(out, token);
} else {
py_methods_append(out, token);
}
}
}
}
return out;
}
 _decimal(token, listed) {
let ends, middle, part, whole;
const self = this;
[whole, part] = py_list(py_re.split(",|\\{,\\}", token));
if ((py_t(listed) && !py_in("{", token))) {
middle = py_add(py_some(token.start_pos, () => 0), py_len(whole));
ends = new Token("NUMBER", part, (middle + 1), { end_pos: py_add((middle + 1), py_len(part)) });
return [token.update({ type: "NUMBER", value: whole }), new Token("COMMA", ",", middle, { end_pos: (middle + 1) }), ends];
}
if ((py_eq(py_len(part), 3) && py_methods_isdigit(part) && !py_eq(whole, "0") && !py_in("{", token))) {
self.refuse(two_meanings([py_add(whole, part), `${py_str(whole)}.${py_str(part)}`], "type it without a comma"), token);
}
return [token.update({ type: "NUMBER", value: `${py_str(whole)}.${py_str(part)}` })];
}
 _environments(tokens) {
let begun, braced, inside, k, opened, out, token;
const self = this;

braced = systems(tokens);
out = [];
opened = [];
for ([k, token] of py_iter(py_enumerate(tokens))) {
if (py_in(token.type, AROUND)) {
py_methods_append(opened, k);
}
inside = py_any(py_gen(py_item(opened, py_slice(-1, null, null)), (each) => !py_eq(py_item(tokens, each).type, "LBRACE"), (each) => !py_in(each, braced)));
begun = ((py_t(opened) && py_in(token.type, py_methods_values(AROUND))) ? py_methods_pop(opened) : k);
if (py_in(begun, braced)) {
out = py_iadd(out, (!py_in("BRACE", token.type) ? [token.update({ type: "_LINE", value: "\n" })] : []));
} else {
if ((py_eq(token.type, "_ROW") && !(py_t(inside)))) {
py_methods_append(out, token.update({ type: "_LINE", value: "\n" }));
} else {
if (((py_eq(token.type, "_CELL") && !(py_t(inside))) || (py_eq(token.type, "_LINE") && py_t(inside)))) {
continue;
} else {
py_methods_append(out, token);
}
}
}
}
return self._braces(out);
}
 _braces(tokens) {
let k, kind, kinds, opened, out, token;
const self = this;

opened = [];
kinds = new Map([]);
for ([k, token] of py_iter(py_enumerate(tokens))) {
if (py_eq(token.type, "SET_OPEN")) {
py_methods_append(opened, k);
} else {
if ((py_eq(token.type, "SET_CLOSE") && py_t(opened))) {
kinds = py_or(kinds, new Map([[py_key(py_methods_pop(opened)), "LPAR"], [py_key(k), "RPAR"]]));
} else {
if (py_eq(token.type, "NOTHING")) {
kinds = py_or(kinds, py_or(new Map([[py_key(k), ""]]), ((py_t(opened) && py_in("right", token)) ? new Map([[py_key(py_methods_pop(opened)), ""]]) : new Map([]))));
}
}
}
}
for (k of py_iter(opened)) {
py_put(kinds, k, "");
}
out = [];
for ([k, token] of py_iter(py_enumerate(tokens))) {
kind = py_methods_get(kinds, k, token.type);
if (py_eq(kind, "SET_CLOSE")) {
self.refuse("this bracket was never opened", token);
}
out = py_iadd(out, (py_t(kind) ? [(!py_eq(kind, token.type) ? token.update({ type: kind }) : token)] : []));
}
return out;
}
 _integrals(tokens) {
let bounds, comma, inside, k, last, lower, many, partner, parts, size, start, upper, variable;
const self = this;

many = py_item(py_list(py_gen(tokens, (token) => token, (token) => py_eq(token.type, "INTEGRAL"))), py_slice(MOST_INTEGRALS, null, null));
if (py_t(many)) {
self.refuse(`more than ${py_str(MOST_INTEGRALS)} integrals stand here; write them in several texts`, py_item(many, 0));
}
for (start of py_iter(py_range((py_len(tokens) - 1), -1, -1))) {
if (!py_eq(py_item(tokens, start).type, "INTEGRAL")) {
continue;
}
partner = partners(tokens);
last = (py_len(tokens) - 1);
lower = py_min((py_methods_get(partner, (start + 1), (start + 1)) + 1), last);
if (!py_eq(py_item(tokens, lower).type, "_POWER")) {
self.refuse("an integral has a lower and an upper bound, \\int_{0}^{t} ... d tau", py_item(tokens, start));
}
upper = py_min((py_methods_get(partner, (lower + 1), (lower + 1)) + 1), last);
k = upper;
while ((!py_in(py_item(tokens, k).type, ["END", "EQUAL", "RELATION", ...py_iter(CLOSING)]) && !(py_t(differential(tokens, k))))) {
k = (py_methods_get(partner, k, k) + 1);
}
size = differential(tokens, k);
if ((!(py_t(size)) || py_eq(k, upper))) {
self.refuse("an integral ends with the letter that varies, as in d tau", py_item(tokens, start));
}
variable = (py_eq(size, 2) ? py_str(py_item(tokens, (k + 1))) : py_item(py_item(tokens, k), py_slice(1, null, null)));
bounds = py_gen(py_item(tokens, py_slice((start + 1), upper, null)), (t) => py_str(t), (t) => py_eq(t.type, "NAME"));
self.bound = py_or(self.bound, py_dict(py_gen([variable, ...py_iter(py_sub(py_set_(bounds), self.known))], (name) => [name, sp.Symbol(name, { real: true })])));
self.bound = py_or(self.bound, (py_any(py_gen(py_item(tokens, py_slice((start + 1), upper, null)), (t) => py_eq(t, "\\infty"))) ? new Map([["infty", sp.oo]]) : new Map([])));
self.known = py_or(self.known, py_set_(self.bound));
function new_(kind, value, at = py_item(tokens, start)) {
return at.update({ type: kind, value: value });
}

comma = new_("COMMA", ",");
parts = [py_item(tokens, py_slice(upper, k, null)), [new_("NAME", variable)], py_item(tokens, py_slice((start + 1), lower, null)), py_item(tokens, py_slice((lower + 1), upper, null))];
inside = py_item(py_list((function* () { for (const part of py_iter(parts)) for (const token of py_iter([...py_iter(part), comma])) yield token; })()), py_slice(null, -1, null));
tokens = [...py_iter(py_item(tokens, py_slice(null, start, null))), ...py_iter([new_("_INTEGRAL", "int"), new_("LPAR", "("), ...py_iter(inside), new_("RPAR", ")")]), ...py_iter(py_item(tokens, py_slice(py_add(k, size), null, null)))];
}
return tokens;
}
 _bars(tokens) {
let closes, ended, kind, opened, out, token, top;
const self = this;

out = [];
opened = [];
for (token of py_iter(tokens)) {
if (!py_in(token.type, ["BAR", "NORM_BAR"])) {
if ((py_in(token.type, CLOSING) && py_t(opened) && !(py_methods_endswith(py_item(opened, -1), "BAR")))) {
py_methods_pop(opened);
}
opened = py_iadd(opened, (py_in(token.type, OPENING) ? [token.type] : []));
py_methods_append(out, token);
continue;
}
top = (py_t(opened) ? py_item(opened, -1) : "");
ended = py_every(py_bool(out), () => py_in(py_item(out, -1).type, _OPERAND_ENDS));
if ((py_eq(token, "||") && py_eq(top, "BAR") && py_t(ended))) {
out = py_iadd(out, [token.update({ type: "_BAR_CLOSE", value: "|" }), token.update({ type: "_BAR_OPEN", value: "|" })]);
continue;
}
closes = (py_in("right", token) || py_in("rv", token) || py_in("rV", token));
closes = py_some(closes, () => py_every(py_eq(top, token.type), () => ended, () => !((py_in("left", token) || py_in("lv", token) || py_in("lV", token)))));
if ((py_t(closes) && py_eq(top, token.type))) {
py_methods_pop(opened);
} else {
if (!(py_t(closes))) {
py_methods_append(opened, token.type);
}
}
kind = (py_eq(token.type, "NORM_BAR") ? "_NORM" : "_BAR");
py_methods_append(out, token.update({ type: `${py_str(kind)}_${py_str((py_t(closes) ? "CLOSE" : "OPEN"))}` }));
}
return out;
}
 _fractions(tokens) {
let digit, k, out, token, wanted;
const self = this;

out = [];
wanted = 0;
for ([k, token] of py_iter(py_enumerate(tokens))) {
if ((py_eq(token.type, "_ROOT") && py_eq(py_item(tokens, (k + 1)).type, "LPAR"))) {
token = token.update({ type: "FUNCTION", value: "sqrt" });
}
if (py_eq(token.type, "_FRACTION")) {
wanted = 2;
} else {
if ((py_t(wanted) && py_eq(token.type, "NUMBER") && py_methods_isdigit(token) && py_compare(py_len(token), "<=", wanted))) {
for (digit of py_iter(token)) {
out = py_iadd(out, [token.update({ type: "LBRACE", value: "{" }), token.update({ value: digit }), token.update({ type: "RBRACE", value: "}" })]);
}
wanted = py_sub(wanted, py_len(token));
continue;
} else {
if ((!py_eq(wanted, 1) || !py_eq(token.type, "LBRACE"))) {
wanted = 0;
}
}
}
py_methods_append(out, token);
}
return out;
}
 _arguments(tokens) {
let closes, end, inverse, k, opens, out, partner, start, token, told;
const self = this;

partner = partners(tokens);
opens = py_set_();
closes = py_set_();
for ([k, token] of py_iter(py_enumerate(tokens))) {
if (!py_eq(token.type, "FUNCTION")) {
continue;
}
start = exponent_end(tokens, partner, (k + 1));
inverse = py_list(py_gen(py_item(tokens, py_slice((k + 1), start, null)), (t) => py_str(t), (t) => !py_in(t.type, ["_POWER", "LBRACE", "RBRACE"])));
if ((py_eq(inverse, ["-", "1"]) && !py_eq(py_item(tokens, start).type, "END"))) {
self.refuse(two_meanings([`1/${py_str(token)}`, `arc${py_str(token)}`], `write 1/${py_str(token)}(...) or arc${py_str(token)}(...)`), token);
}
end = unit_end(tokens, partner, start);
if (py_is(end, null)) {
continue;
}
if (py_in(py_item(tokens, end).type, _OPERAND_STARTS)) {
told = [`${py_str(token)} of all that follows`, `${py_str(token)} times what follows`];
self.refuse(two_meanings(told, `write brackets, ${py_str(token)}(...)`), py_item(tokens, end));
}
py_methods_add(opens, start);
py_methods_add(closes, end);
}
out = [];
for ([k, token] of py_iter(py_enumerate(tokens))) {
out = py_iadd(out, py_mul([token.update({ type: "RPAR", value: ")" })], py_in(k, closes)));
out = py_iadd(out, py_mul([token.update({ type: "LPAR", value: "(" })], py_in(k, opens)));
py_methods_append(out, token);
}
return out;
}
}
const _CONTINUES = new Set("COMMA EQUAL LBRACE LPAR LSQB MINUS PLUS RELATION SLASH _POWER _TIMES".split(' '));
const _GOES_ON = new Set("EQUAL MINUS PLUS RBRACE RELATION RPAR RSQB SLASH _POWER _TIMES".split(' '));
const _N = "NAME:(\\w+)";
const _MANY = "NAME:(\\w+)(?: (?:_ROW|COMMA|_LINE|_CELL) NAME:(\\w+))*";
const _LABEL = py_constant('_LABEL', false);
class Words extends Notation {
 tokens(strict = true) {
let each, found, lines, passes;
const self = this;

found = self._raw();
passes = [py_bound(self, "_sums"), py_bound(self, "_names"), py_bound(self, "_numbers"), py_bound(self, "_environments"), py_bound(self, "_integrals"), py_bound(self, "_times"), py_bound(self, "_joined")];
lines = (py_t(strict) ? [py_bound(self, "_lines")] : []);
for (each of py_iter([...py_iter(passes), ...py_iter(lines), py_bound(self, "_told"), py_bound(self, "_bars"), py_bound(self, "_fractions"), py_bound(self, "_arguments")])) {
found = (py_t(strict) ? each(found) : self._leniently(each, found));
}
return found;
}
 _leniently(change, tokens) {
let after, before, kinds, out, token;
const self = this;

try {
return change(tokens);
} catch (error_) { if (!(error_ instanceof CannotRead)) throw error_; }
if (!py_eq(change, py_bound(self, "_told"))) {
return tokens;
}
kinds = py_list(py_gen(tokens, (token) => token.type));
out = [];
for ([token, before, after] of py_iter(py_zip(tokens, ["", ...py_iter(kinds)], [...py_iter(py_item(kinds, py_slice(1, null, null))), ""]))) {
try {
out = py_iadd(out, self._told_apart(token, before, after));
} catch (error_) {
if (!(error_ instanceof CannotRead)) throw error_;
py_methods_append(out, token);
}
}
return out;
}
 _names(tokens) {
let bare, k, kinds, middle, out, token, variant;
const self = this;

out = [];
kinds = py_list(py_gen(tokens, (token) => token.type));
for ([k, token] of py_iter(py_enumerate(tokens))) {
if (py_eq(token.type, "RATE")) {
token = token.update({ type: "NAME", value: rate_of(token) });
} else {
if (py_eq(token.type, "CROSS")) {
token = token.update({ type: "NAME", value: "wcross" });
} else {
if ((py_eq(token.type, "NAME") && py_eq(py_item(kinds, (k - 1)), "_POWER") && py_t(py_re.match("T[A-Za-z]", token)) && !py_in(token, self.known))) {
middle = (py_some(token.start_pos, () => 0) + 1);
py_methods_append(out, new Token("NAME", "T", (middle - 1), { end_pos: middle }));
token = new Token("NAME", name_of(py_item(token, py_slice(1, null, null))), middle, { end_pos: token.end_pos });
} else {
if (py_eq(token.type, "NAME")) {
variant = name_of(py_methods_replace(token, "\\var", "var"));
token = token.update({ value: (py_in(variant, self.letters) ? variant : name_of(token)) });
bare = py_item(kinds, py_slice(py_max((k - 3), 0), k, null));
if ((py_eq(py_item(bare, py_slice(-1, null, null)), ["D_DT"]) || py_eq(bare, ["LPAR", "D_DT", "RPAR"]))) {
py_del(out, py_slice((py_eq(py_item(bare, py_slice(-1, null, null)), ["D_DT"]) ? -1 : -3), null, null));
token = token.update({ value: key(`${py_str(token)}dot`) });
} else {
if ((py_eq(py_item(bare, py_slice(-2, null, null)), ["D_DT", "LPAR"]) && py_in("RPAR", [py_item(kinds, (k + 1)), py_item(kinds, py_slice((k + 4), (k + 5), null))]))) {
py_del(out, -2);
token = token.update({ value: key(`${py_str(token)}dot`) });
}
}
}
}
}
}
py_methods_append(out, token);
}
return out;
}
 _times(tokens) {
let at, end, first, inner, k, name, out, partner;
const self = this;

out = [];
first = new Map([]);
partner = partners(tokens);
k = 0;
while (py_compare(k, "<", py_len(tokens))) {
end = py_methods_get(partner, k, k);
inner = py_item(tokens, py_slice((k + 1), end, null));
if ((py_eq(py_item(tokens, k).type, "LBRACE") && py_eq(py_list(py_gen(inner, (t) => t.type)), ["LPAR", "NAME", "RPAR"]))) {
inner = py_item(inner, py_slice(1, 2, null));
}
if ((py_eq(end, k) || !(py_t(self._takes_time(out, py_item(tokens, k)))) || !(py_t((name = self._applied(out, inner, first)))))) {
py_methods_append(out, py_item(tokens, k));
k = py_iadd(k, 1);
continue;
}
at = py_max(py_gen(py_enumerate(out), ([j, token]) => j, ([j, token]) => (py_in(token.type, ["NAME", "RBRACE"]) && !py_eq(token, "T"))));
if ((!py_eq(name, py_item(out, at)) && py_eq(py_item(out, at).type, "NAME"))) {
py_put(out, at, py_item(out, at).update({ value: name }));
}
k = (end + 1);
}
return out;
}
 _applied(before, inner, first) {
let known, letter, numbers, of_numbers, text, timed, told, unknown, words;
const self = this;

letter = py_next(py_gen(py_reversed(py_item(before, py_slice(-6, null, null))), (t) => py_str(t), (t) => (py_eq(t.type, "NAME") && !py_eq(t, "T"))), "");
text = py_methods_join("", py_map(py_str, inner));
if (py_t(py_re.fullmatch("ti\\^?\\{?\\^?\\{?[+-]\\}?\\}?", text))) {
return (py_in("+", text) ? key(`${py_str(letter)}plus`) : letter);
}
if (py_eq(text, "t0")) {
return `${py_str(letter)}0`;
}
if ((py_eq(text, "t") && py_in("t", self.letters) && py_in(letter, self.letters))) {
told = [`${py_str(letter)} at the time t`, `${py_str(letter)} times t`];
self.refuse(two_meanings(told, "write * or a blank between"), py_item(before, -1));
}
if ((py_eq(text, "t") || py_t(self._only_times(inner)))) {
return letter;
}
if ((!py_in(self._spelled(letter), self.known) && !(py_t(self._ways(letter))))) {
return "";
}
words = py_list(py_gen(inner, (t) => py_str(t), (t) => py_eq(t.type, "NAME")));
unknown = py_list(py_gen(words, (word) => word, (word) => (!py_in(self._spelled(word), self.letters) && !(py_t(self._ways(word))))));
numbers = py_methods_get(self.letters, self._spelled(letter));
of_numbers = (py_isinstance(numbers, sp.Expr) && !(py_isinstance(numbers, sp.MatrixExpr)));
if (py_is(top_level(inner, 0, "COMMA"), null)) {
timed = py_every(py_compare(py_len(inner), ">", 3), () => py_eq(py_item(inner, 0).type, "NAME"), () => self._only_times(py_item(inner, py_slice(2, -1, null))), () => py_eq(py_item(inner, 1).type, "LPAR"));
return ((py_t(timed) || (py_eq(unknown, words) && py_t(words) && !(py_t(of_numbers)))) ? letter : "");
}
if ((py_t(of_numbers) && !(py_t(unknown)))) {
return "";
}
if ((py_any(py_gen(words, (word) => py_in("hat", word))) && py_in(key(`${py_str(letter)}hat`), self.known))) {
return key(`${py_str(letter)}hat`);
}
known = py_methods_setdefault(first, letter, words);
return py_add(letter, py_methods_rstrip(py_next(py_gen(words, (word) => word, (word) => !py_in(word, known)), ""), "0123456789"));
}
 _only_times(inner) {
let names, times;
const self = this;

times = py_sub(new Set(["t", "s", "tau"]), py_set_(self.letters));
names = py_list(py_gen(inner, (t) => t, (t) => py_eq(t.type, "NAME")));
return py_every(py_bool(names), () => py_all(py_gen(inner, (t) => (py_in(t.type, ["PLUS", "MINUS"]) || py_in(t, times)))));
}
 _takes_time(before, bracket) {
let between, exponent, last;
const self = this;

if (!(py_t(before))) {
return false;
}
last = py_item(before, -1);
between = py_item(self.plain, py_slice(py_some(last.end_pos, () => 0), bracket.start_pos, null));
if ((py_t(py_methods_removeprefix(py_methods_strip(between), "\\left")) || py_methods_isspace(py_item(between, py_slice(null, 1, null))))) {
return false;
}
if (py_eq(last.type, "NAME")) {
return (!py_in(py_str(last), FUNCTIONS) && !py_in(py_str(last), self.functions));
}
exponent = (py_compare(py_len(before), ">", 1) && py_eq(py_item(before, -2).type, "_POWER"));
return py_some(py_eq(last.type, "RAISED"), () => py_every(py_eq(last.type, "NUMBER"), () => exponent), () => (py_eq(last.type, "RBRACE") && py_in("_POWER", py_list(py_gen(py_item(before, py_slice(-5, null, null)), (t) => t.type)))));
}
 _lines(tokens) {
let at, end, label, line, out, rest, vector;
const self = this;

out = [];
for ([line, end] of py_iter(self._unwrapped(split(tokens)))) {
line = self._without_remark(line);
rest = (py_next(py_gen(py_enumerate(py_item(line, py_slice(null, 2, null))), ([k, token]) => k, ([k, token]) => py_eq(token.type, "EQUAL")), 0) + 1);
if ((py_eq(rest, 2) && py_t(py_item(line, py_slice(2, 3, null))) && py_in(py_item(line, 2).type, ["LSQB", "LPAR"]) && py_t((vector = self._label(py_item(line, py_slice(2, null, null))))))) {
line = [vector, ...py_iter(py_item(line, py_slice(py_add(2, py_next(py_gen(py_enumerate(py_item(line, py_slice(2, null, null))), ([k, t]) => k, ([k, t]) => py_eq(t.type, "EQUAL")))), null, null)))];
out = py_iadd(out, [...py_iter(line), end]);
continue;
}
label = self._label(line);
if (py_t(label)) {
at = py_next(py_gen(py_enumerate(line), ([k, token]) => k, ([k, token]) => py_eq(token.type, "EQUAL")));
line = [label, ...py_iter(py_item(line, py_slice(at, null, null)))];
}
out = py_iadd(out, [...py_iter(line), end]);
}
return out;
}
 _joined(tokens) {
let after, before, bullets, following, goes_on, k, opened, out, related, token, told;
const self = this;

out = [];
opened = [];
related = false;
bullets = py_sum(py_gen(py_range(py_len(tokens)), (k) => bullet(tokens, k)));
following = py_mul([(py_len(tokens) - 1)], py_len(tokens));
for (k of py_iter(py_range((py_len(tokens) - 2), -1, -1))) {
py_put(following, k, (!py_eq(py_item(tokens, (k + 1)).type, "_LINE") ? (k + 1) : py_item(following, (k + 1))));
}
for ([k, token] of py_iter(py_enumerate(tokens))) {
if (py_in(token.type, OPENING)) {
py_methods_append(opened, token.type);
} else {
if ((py_in(token.type, CLOSING) && py_t(opened))) {
py_methods_pop(opened);
}
}
if ((!(py_t(opened)) && py_t(bullet(tokens, k)))) {
if ((py_eq(token.type, "MINUS") && py_eq(bullets, 1))) {
self.refuse(two_meanings(["a list", "a minus sign"], "leave the sign or the blank behind it out"), token);
}
continue;
}
if ((!py_eq(token.type, "_LINE") || py_in(";", token))) {
related = py_some(related, () => py_in(token.type, ["EQUAL", "RELATION"]));
related = py_every(related, () => py_some(py_bool(opened), () => !py_in(token.type, ["_LINE", "COMMA"])));
py_methods_append(out, token);
continue;
}
after = py_item(tokens, py_item(following, k));
before = (py_t(out) ? py_item(out, -1).type : "_LINE");
if (py_t(opened)) {
goes_on = (!py_eq(py_item(opened, -1), "LSQB") || py_in(before, _CONTINUES) || py_in(after.type, py_or(_GOES_ON, new Set(["COMMA"]))));
goes_on = py_every(goes_on, () => !((py_in("quad", token) && py_eq(py_item(opened, -1), "LSQB") && !py_in(before, _CONTINUES))));
} else {
if (py_t(bullet(tokens, py_item(following, k)))) {
goes_on = false;
} else {
goes_on = (py_in(before, py_sub(_CONTINUES, new Set(["COMMA"]))) || (py_in(after.type, _GOES_ON) && !py_in(before, ["_LINE", "COMMA"])));
if ((py_t(goes_on) && py_eq(after.type, "MINUS") && !py_in(before, _CONTINUES) && !(py_t(related)))) {
told = ["a line of its own", "going on with the line before"];
self.refuse(two_meanings(told, "end the line before with ; or write both in one line"), after);
}
}
}
if (!(py_t(goes_on))) {
related = false;
py_methods_append(out, token);
}
}
return out;
}
* _unwrapped(lines) {
let called, comma, end, equal, line, start;
const self = this;

for ([line, end] of py_iter(lines)) {
start = ((py_compare(py_len(line), ">", 2) && py_eq(py_item(line, 1).type, "EQUAL")) ? 2 : 0);
called = py_in(py_list(py_gen(py_item(line, py_slice(start, (start + 2), null)), (t) => py_str(t))), [["Eq", "("], ["Equality", "("]]);
comma = (py_t(called) ? top_level(line, (start + 2), "COMMA") : null);
if ((py_is(comma, null) || !py_eq(py_item(line, -1).type, "RPAR"))) {
yield [line, end];
} else {
equal = py_item(line, comma).update({ type: "EQUAL", value: "=" });
yield [[...py_iter(py_item(line, py_slice((start + 2), comma, null))), equal, ...py_iter(py_item(line, py_slice((comma + 1), -1, null)))], end];
}
}
}
 _without_remark(line) {
let k, said, words;
const self = this;

k = (py_len(line) - 1);
while ((py_t(line) && py_eq(py_item(line, -1).type, "RPAR") && py_eq(py_item(line, (k - 1)).type, "NAME"))) {
k = py_sub(k, 1);
}
words = py_item(line, py_slice(k, -1, null));
said = py_every(words, () => py_eq(py_item(line, (k - 1)).type, "LPAR"), () => py_compare(k, ">", 1), () => py_all(py_gen(words, (t) => (py_methods_isalpha(t) && py_compare(py_len(t), ">", 2)))));
return ((py_t(said) && !(py_any(py_gen(words, (t) => py_some(py_in(self._spelled(t), self.known), () => self._ways(t)))))) ? py_item(line, py_slice(null, (k - 1), null)) : line);
}
 _label(line) {
let end, kinds, match, name, names, rate, text, there, told, vector;
const self = this;

end = py_next(py_gen(py_enumerate(py_item(line, py_slice(null, 200, null))), ([k, token]) => k, ([k, token]) => py_eq(token.type, "EQUAL")), null);
if ((py_is(end, null) || !py_in(py_item(line, 0).type, ["D_DT", "NAME", "LPAR", "LSQB", "_MATRIX"]))) {
return null;
}
kinds = py_list(py_gen(py_item(line, py_slice(null, (end + 1), null)), (t) => (py_eq(t.type, "NAME") ? `NAME:${py_str(t)}` : t.type), (t) => !py_in(t, WRAPPERS)));
text = py_methods_join(" ", kinds);
if ((py_eq(py_item(kinds, 0), "LPAR") && py_eq(py_item(kinds, -2), "RPAR") && (!py_in("COMMA", kinds) || py_eq(py_item(kinds, 1), "LSQB")))) {
text = py_methods_join(" ", [...py_iter(py_item(kinds, py_slice(1, -2, null))), "EQUAL"]);
}
match = _LABEL.fullmatch(text);
if (!(py_t(match))) {
return null;
}
vector = py_any(py_gen(["_MATRIX", "LSQB", "COMMA"], (kind) => py_in(kind, kinds)));
names = (py_methods_startswith(text, "NAME:J LPAR") ? ["J"] : py_re.findall(_N, text));
if (py_in("_POWER", kinds)) {
names = (py_t(vector) ? py_item(names, py_slice(null, -1, null)) : [py_methods_join("", names)]);
}
names = py_list(py_gen(names, (name) => self._spelled((py_eq(py_item(kinds, 0), "D_DT") ? key(`${py_str(name)}dot`) : name))));
name = py_methods_join(",", names);
if ((py_t(vector) && !py_in("_MATRIX", kinds) && py_all(py_gen(names, (part) => py_in(part, self.letters))))) {
return null;
}
if (!(py_all(py_gen(names, (part) => py_in(part, self.known))))) {
rate = py_re.fullmatch("[dD](\\w+)", name);
if ((py_t(rate) && py_in(key(`${py_str(py_item(rate, 1))}dot`), self.labels))) {
told = [`the rate of ${py_str(py_item(rate, 1))}`, "a letter of your own"];
self.refuse(two_meanings(told, `for the rate write ${py_str(py_item(rate, 1))}' =`), py_item(line, 0));
}
if ((py_any(py_gen(["dot", "hat", ","], (accent) => py_in(accent, name))) || py_in(name, FUNCTIONS))) {
there = py_methods_join(", ", py_sorted(self.labels));
self.refuse(`there is no line "${py_str(name)}"; there are ${py_str(there)}`, py_item(line, 0));
}
py_methods_add(self.known, name);
}
return py_item(line, 0).update({ type: "LABEL", value: name });
}
 _spelled(name) {
const self = this;

return py_next(py_gen([name, ...py_iter(other_names(name))], (each) => each, (each) => py_in(each, self.known)), name);
}
 _told(tokens) {
let after, k, out, token;
const self = this;

out = [];
for ([k, token] of py_iter(py_enumerate(tokens))) {
after = (py_compare((k + 1), "<", py_len(tokens)) ? py_item(tokens, (k + 1)).type : "");
out = py_iadd(out, self._told_apart(token, (py_t(k) ? py_item(tokens, (k - 1)).type : ""), after));
}
return out;
}
 _told_apart(token, before, after) {
let called, guess, kinds, known, name, near, start, transpose, typed, way, ways;
const self = this;
name = py_str(token);
if (py_eq(token.type, "COMMAND")) {
name = py_re.sub("\\\\(operatorname|mathrm|textrm|text|rm)(?![A-Za-z])|\\W", "", name);
if ((py_eq(name, "sech") && py_in(" ", token) && py_in("h", self.known))) {
self.refuse(two_meanings(["sech", "sec of h"], "write sech(...) or sec(h)"), token);
}
if ((!py_in(name, new Set([...py_iter(FUNCTIONS), ...py_iter(self.known)])) && !((py_eq(name, "e") && py_eq(after, "_POWER"))))) {
self.refuse(about_command(name), token);
}
token = token.update({ type: "NAME", value: name });
if ((py_eq(name, "infty") && py_in("infty", self.bound))) {
return [token];
}
}
transpose = (py_eq(name, "T") && py_in(before, ["_POWER", "LBRACE"]));
if ((!py_eq(token.type, "NAME") || py_t(transpose))) {
return [token];
}
if ((py_in(name, WRAPPERS) && py_eq(after, "LPAR") && !py_in(name, self.known))) {
return [];
}
name = self._spelled(name);
if ((py_in(name, self.known) || py_t(self.column(name)))) {
return [token.update({ value: name })];
}
kinds = py_or(py_or(new Map([["pi", "PI"]]), py_methods_fromkeys(py_dict, FUNCTIONS, "FUNCTION")), py_methods_fromkeys(py_dict, self.functions, "USER_FUNCTION"));
kinds = py_or(kinds, (py_eq(after, "_POWER") ? new Map([["e", "EULER"]]) : new Map([])));
kinds = (py_eq(after, "LPAR") ? py_or(new Map([["norm", "FUNCTION"]]), kinds) : kinds);
if (py_in(name, kinds)) {
return [token.update({ type: py_item(kinds, name), value: name })];
}
if (py_compare(py_len(name), ">", LONGEST_WORD)) {
self.refuse(`a word has more than ${py_str(LONGEST_WORD)} letters; write * between letters`, token);
}
ways = self._ways(name);
if (py_eq(py_len(ways), 1)) {
return py_list(py_gen(py_item(ways, 0), (part) => token.update({ value: self._spelled(key(part)) })));
}
if (py_t(ways)) {
self.refuse(`"${py_str(name)}" can be read as ${py_str(py_methods_join(" or ", py_map(" ".join, ways)))}; write * between`, token);
}
called = py_list(py_gen(FUNCTIONS, (each) => each, (each) => (py_methods_endswith(name, each) && py_eq(py_len(self._ways(py_methods_removesuffix(name, each))), 1))));
if ((py_eq(after, "LPAR") && py_eq(py_len(called), 1))) {
[way] = py_list(self._ways(py_methods_removesuffix(name, py_item(called, 0))));
return [...py_iter(py_gen(way, (part) => token.update({ value: part }))), token.update({ type: "FUNCTION", value: py_item(called, 0) })];
}
near = py_difflib.get_close_matches(name, self.letters, 1, 0.5);
known = py_methods_join(", ", py_item(py_sorted(py_gen(py_methods_values(self.letters), (letter) => py_str(letter), (letter) => py_t(letter.is_Symbol))), py_slice(null, 40, null)));
guess = (py_t(near) ? `, did you mean "${py_str(py_item(self.letters, py_item(near, 0)))}"? There are` : "; there are");
start = py_some(token.start_pos, () => 0);
typed = py_item(self.text, py_slice(py_item(self.origin, start), (py_item(self.origin, (py_some(token.end_pos, () => (start + 1)) - 1)) + 1), null));
self.refuse(`"${py_str(py_item(typed, py_slice(null, 40, null)))}" is no letter here${py_str(guess)} ${py_str(known)}`, token);
}
 column(name) {
let found;
const self = this;

found = py_list(py_gen(py_range(1, 10), (k) => py_item(self.letters, `${py_str(name)}${py_str(k)}`), (k) => py_in(`${py_str(name)}${py_str(k)}`, self.letters)));
return ((py_compare(py_len(found), ">", 1) && !py_in(name, self.letters)) ? found : []);
}
 _ways(name) {
let end, start, ways;
const self = this;

ways = [[[]], ...py_iter(py_gen(name, (_) => []))];
for (end of py_iter(py_range(1, (py_len(name) + 1)))) {
for (start of py_iter(py_range(end))) {
if ((py_t(py_item(ways, start)) && py_in(self._spelled(key(py_item(name, py_slice(start, end, null)))), self.letters))) {
py_put(ways, end, py_iadd(py_item(ways, end), py_list(py_gen(py_item(ways, start), (way) => [...py_iter(way), py_item(name, py_slice(start, end, null))]))));
}
}
py_put(ways, end, py_item(py_item(ways, end), py_slice(null, 2, null)));
}
return py_item(ways, -1);
}
}
export { Notation, Words, _blank, _delimited, _line, _outside, _parted, _plain, _said, _without_stop, about_character, about_command, about_token, bullet, differential, exponent_end, indexed, laid_out, name_of, other_names, partners, rate_of, spelled, split, systems, top_level, two_meanings, unit_end };
