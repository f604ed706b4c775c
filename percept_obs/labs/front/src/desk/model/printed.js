// @ts-nocheck
// Printed by Python from percept_obs.checking.refusing, percept_obs.checking.spelling, percept_obs.checking.words: change those, not this.
import { py, CannotRead, Token, UnexpectedCharacters, _terminal, key, lexed } from "./python.js";

const py_add = py.add;
const py_all = py.all;
const py_any = py.any;
const py_bool = py.bool;
const py_bound = py.bound;
const py_compare = py.compare;
const py_del = py.del;
const py_dict = py.dict;
const py_difflib = py.difflib;
const py_enumerate = py.enumerate;
const py_eq = py.eq;
const py_every = py.every;
const py_hasattr = py.hasattr;
const py_iadd = py.iadd;
const py_in = py.in;
const py_int = py.int;
const py_is = py.is;
const py_isinstance = py.isinstance;
const py_item = py.item;
const py_iter = py.iter;
const py_join = py.join;
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
const py_methods_join = py.methods.join;
const py_methods_lower = py.methods.lower;
const py_methods_lstrip = py.methods.lstrip;
const py_methods_pop = py.methods.pop;
const py_methods_removeprefix = py.methods.removeprefix;
const py_methods_removesuffix = py.methods.removesuffix;
const py_methods_replace = py.methods.replace;
const py_methods_rstrip = py.methods.rstrip;
const py_methods_split = py.methods.split;
const py_methods_startswith = py.methods.startswith;
const py_methods_strip = py.methods.strip;
const py_methods_values = py.methods.values;
const py_min = py.min;
const py_mul = py.mul;
const py_next = py.next;
const py_or = py.or;
const py_pattern = py.pattern;
const py_put = py.put;
const py_range = py.range;
const py_re = py.re;
const py_repr = py.repr;
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
const CLOSING = new Map([["RPAR", "("], ["RBRACE", "{"], ["RSQB", "["], ["_BAR_CLOSE", "|"], ["_NORM_CLOSE", "||"], ["_END_MATRIX", "\\begin"], ["_END_CASES", "\\begin"]]);
function two_meanings(readings, instead) {

return py_join(["this can be read as ", py_str(py_methods_join(" or as ", readings)), "; ", py_str(instead)]);
}

function about_character(c) {
let name;

name = py_unicodedata.name(c, "a control character");
if (py_eq(c, "_")) {
return "an index is letters and digits, as in y_1 or v_{c1}";
}
if (py_methods_isalpha(c)) {
return py_join([py_repr(c), " is ", py_str(name), "; letters are Latin or Greek, so type the letter that it looks like"]);
}
return py_join([py_repr(c), " (", py_str(py_methods_lower(name)), ") has no meaning in a formula; there are letters, numbers and + - * / ^ ( ) ="]);
}

function about_command(name) {

if (py_in(name, ["hat", "bar", "dot", "tilde", "widehat", "widetilde", "overline"])) {
return py_join(["\\", py_str(name), " stands over a letter, as in \\", py_str(name), "{y}_{1}"]);
}
if (py_in(name, ["begin", "end"])) {
return "of LaTeX's environments matrices, arrays, cases and those of equations and lines are read";
}
return py_join(["\\", py_str(name), " is not read; there are \\frac, \\sqrt, \\sum with numbers, functions, Greek letters, matrices"]);
}

function about_token(token, accepted) {
let end, open_brackets;

open_brackets = py_list((function* () { for (const kind of py_iter(accepted)) if (py_in(kind, CLOSING)) yield py_item(CLOSING, kind); })());
if (py_compare(accepted, "<=", new Set([py_key("LPAR"), py_key("LBRACE"), py_key("_POWER"), py_key("RAISED")]))) {
return "a function takes its argument in brackets, as in sin(...), and a command in braces";
}
if ((py_in("NAME", accepted) && !py_in("_TIMES", accepted))) {
end = py_eq(token.type, "$END");
return py_join([py_str((py_t(end) ? "the formula ends too early: " : "")), "a number, a letter or a bracket is expected here"]);
}
if (py_in(token.type, ["_POWER", "RAISED"])) {
return "a power of a power needs brackets: (x^2)^3";
}
if (py_eq(token.type, "NUMBER")) {
return "a number after a factor can mean two things; write * or ^ before it";
}
if (py_t(open_brackets)) {
return py_join(["the bracket ", py_str(py_item(open_brackets, 0)), " is not closed"]);
}
if (py_in(token.type, CLOSING)) {
return "this bracket was never opened";
}
return "an operator or the end of the line is expected here";
}

const ACCENTS = new Map([["\u0302", "hat"], ["\u0304", "bar"], ["\u0307", "dot"], ["\u0303", "tilde"]]);
const _OVER = new Map([["hat", "hat"], ["bar", "bar"], ["dot", "dot"], ["tilde", "tilde"], ["widehat", "hat"], ["widetilde", "tilde"], ["overline", "bar"]]);
const REPLACED = new Map([["\u03b1", "alpha"], ["\u03b2", "beta"], ["\u03b3", "gamma"], ["\u03b4", "delta"], ["\u03b5", "epsilon"], ["\u03b6", "zeta"], ["\u03b7", "eta"], ["\u03b8", "theta"], ["\u03b9", "iota"], ["\u03ba", "kappa"], ["\u03bb", "lambda"], ["\u03bc", "mu"], ["\u03bd", "nu"], ["\u03be", "xi"], ["\u03bf", "omicron"], ["\u03c0", "pi"], ["\u03c1", "rho"], ["\u03c3", "sigma"], ["\u03c4", "tau"], ["\u03c5", "upsilon"], ["\u03c6", "phi"], ["\u03c7", "chi"], ["\u03c8", "psi"], ["\u03c9", "omega"], ["\u0393", "Gamma"], ["\u0394", "Delta"], ["\u0398", "Theta"], ["\u039b", "Lambda"], ["\u039e", "Xi"], ["\u03a0", "Pi"], ["\u03a3", "Sigma"], ["\u03a6", "Phi"], ["\u03a8", "Psi"], ["\u03a9", "Omega"], ["\u03f5", "epsilon"], ["\u03d1", "theta"], ["\u03d5", "phi"], ["\u03f1", "rho"], ["\u03d6", "pi"], ["\u2080", "0"], ["\u2081", "1"], ["\u2082", "2"], ["\u2083", "3"], ["\u2084", "4"], ["\u2085", "5"], ["\u2086", "6"], ["\u2087", "7"], ["\u2088", "8"], ["\u2089", "9"], ["\u2212", "-"], ["\u2013", "-"], ["\u00b7", "*"], ["\u22c5", "*"], ["\u00d7", "*"], ["\u2217", "*"], ["\u2032", "'"], ["\u2019", "'"], ["\u27e8", "("], ["\u27e9", ")"], ["\u2260", "!="], ["\u2264", "<="], ["\u2265", ">="], ["\u00bd", "(1/2)"], ["\u00bc", "(1/4)"], ["\u00be", "(3/4)"], ["\u2153", "(1/3)"], ["\u2154", "(2/3)"], ["\u2016", "||"], ["\u221a", "\\sqrt"], ["\u2211", "\\sum"], ["\u2261", "\\equiv"], ["\u2254", ":="], ["\u225c", "\\triangleq"], ["\u1d40", "^{\\top}"], ["\u2033", "''"], ["\u2009", " "], ["\u202f", " "], ["\u00a0", " "], ["\u2002", " "], ["\u2003", " "], ["\u2061", " "], ["\u2062", " "]]);
const _RELATION = py_pattern("[=<>]|\\\\(neq?|leq?|geq?|lt|gt|equiv|triangleq|coloneqq)(?![A-Za-z])");
const _FORMULA = py_pattern("[+*/^=<>()\\[\\]{}&\\\\]|(^|\\s)-|-(\\s|$)|[\\d_']\\w*\\s+\\w*[\\d_']");
const _SAID = py_pattern("\\\\(text|textrm|mbox|mathrm)\\s*\\{([^{}]*)\\}");
const _WORDS_OF_CASES = py_pattern("\\s*(for|if|when|otherwise|else)[,.]?\\s*|\\s*\\w+\\s*");
const _NAMED_BY_COLON = py_pattern("[\\s{]*[A-Za-z]\\w*(dot|')\\s*:(?!=)[^=<>]*");
function spelled(text) {
let pieces;

pieces = py_list((function* () { for (const c of py_iter(text)) yield _plain(c); })());
return [py_methods_join("", pieces), py_list((function* () { for (const [k, piece] of py_iter(py_enumerate(pieces))) for (const _ of py_iter(piece)) yield k; })())];
}

function _plain(c) {
if ((py_in(c, REPLACED) || py_methods_isascii(c))) {
return py_methods_get(REPLACED, c, c);
}
if (py_methods_startswith(py_unicodedata.name(c, ""), "MATHEMATICAL")) {
c = py_unicodedata.normalize("NFKC", c);
}
return py_some(py_methods_get(REPLACED, c), () => py_methods_join("", (function* () { for (const d of py_iter(py_unicodedata.normalize("NFD", c))) yield py_methods_get(REPLACED, d, d); })()));
}

function laid_out(text) {
let lines;

text = _delimited(text);
lines = py_list((function* () { for (const line of py_iter(py_methods_split(py_re.sub("(?<!\\\\)\\\\\\n", "  ", text), "\n"))) yield _line(line); })());
return py_methods_join("\n", lines);
}

function _blank(text) {
return py_methods_join("", (function* () { for (const c of py_iter(text)) yield (py_eq(c, "\n") ? c : " "); })());
}

function _delimited(text) {
let end, inside, kept, kind, mark, marks, opened, out, outside, related, start, whole;

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
outside = _outside(text, inside);
whole = py_list((function* () { for (const [start, end] of py_iter(inside)) yield py_item(text, py_slice(start, end, null)); })());
for ([start, end] of py_iter(marks)) {
text = py_add(py_add(py_item(text, py_slice(null, start, null)), py_mul(" ", py_sub(end, start))), py_item(text, py_slice(end, null, null)));
}
if ((!(py_t(inside)) || py_t(_RELATION.search(outside)))) {
return text;
}
related = py_any((function* () { for (const part of py_iter(whole)) yield _RELATION.search(part); })());
kept = py_list((function* () { for (const [span, part] of py_iter(py_zip(inside, whole))) if ((py_t(_RELATION.search(part)) || !(py_t(related)))) yield span; })());
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

const _PARTNER = new Map([["\\]", "\\["], ["\\)", "\\("]]);
function _outside(text, inside) {
let ends, starts;
ends = [0, ...py_iter((function* () { for (const [_, end] of py_iter(inside)) yield end; })())];
starts = [...py_iter((function* () { for (const [start, _] of py_iter(inside)) yield start; })()), py_len(text)];
return py_methods_join(" ", (function* () { for (const [end, start] of py_iter(py_zip(ends, starts))) yield py_item(text, py_slice(end, start, null)); })());
}

function _line(line) {
let numbered, parts, start, words;

line = _terminal("COMMENT").sub(((found) => py_mul(" ", py_len(py_item(found, 0)))), line);
line = py_re.sub("^\\s*>|^\\s*\\*\\*(?=\\S)|(?<=\\S)\\*{1,3}\\s*$|^\\s*\\*(?=[A-Za-z\\\\])", ((f) => py_mul(" ", py_len(py_item(f, 0)))), line);
start = py_sub(py_len(line), py_len(py_methods_lstrip(line)));
if (py_t((numbered = _terminal("NUMBERED").match(line, start)))) {
line = py_add(py_mul(" ", numbered.end()), py_item(line, py_slice(numbered.end(), null, null)));
}
line = py_re.sub("(?<=\\s\\s|.,|ad)\\s*\\((\\d{1,2}[a-z]?)\\)\\s*[.,]?\\s*$", ((f) => py_mul(" ", py_len(py_item(f, 0)))), line);
if (py_t(_NAMED_BY_COLON.fullmatch(line))) {
line = py_methods_replace(line, ":", "=", 1);
if (py_methods_startswith(py_methods_lstrip(line), "{")) {
line = py_methods_removesuffix(py_methods_rstrip(py_methods_replace(line, "{", " ", 1)), "}");
}
}
line = _SAID.sub(_said, line);
words = py_re.split("(\\s+)", line);
line = py_methods_join("", (function* () { for (const word of py_iter(words)) yield _without_stop(word); })());
if ((!(py_t(_terminal("PROSE").search(line))) && !py_in("\n", line))) {
return line;
}
parts = py_methods_split(_terminal("PROSE").sub(((f) => py_add("\n", py_mul(" ", (py_len(py_item(f, 0)) - 1)))), line), "\n");
return py_methods_join("\n", (function* () { for (const part of py_iter(parts)) yield (py_t(_FORMULA.search(part)) ? part : _blank(part)); })());
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
if ((py_methods_endswith(bare, [".", "!", "?"]) && !(py_methods_isdigit(py_item(bare, py_slice(null, -1, null)))))) {
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
over = py_re.findall(py_join(["\\\\(", py_str(py_methods_join("|", _OVER)), ")(?![A-Za-z])"]), text);
accents = [...py_iter((function* () { for (const each of py_iter(over)) yield py_item(_OVER, each); })()), ...py_iter((function* () { for (const c of py_iter(text)) if (py_in(c, ACCENTS)) yield py_item(ACCENTS, c); })())];
plain = py_re.sub(py_join(["\\\\(", py_str(py_methods_join("|", _OVER)), ")(?![A-Za-z])|[", py_str(marks), "',]"]), "", text);
return key(py_add(py_add(plain, py_methods_join("", accents)), py_mul("dot", py_methods_count(text, "'"))));
}

const _ENVELOPE = py_pattern("^(\\\\[dt]?frac\\s*\\{\\s*)?(Derivative\\s*\\(|diff\\s*\\(|dot\\s*\\(|Symbol\\s*\\(\\s*'|d(?=[\\s\\\\A-Za-z])|\u2202|\\\\partial|\\\\mathrm\\s*(\\{\\s*d\\s*\\}|d)|\\\\rm\\s+d)\\s*");
const _END = py_pattern("(\\s*\\(\\s*t\\s*\\))?\\s*(\\}\\s*\\{[^{}]*(\\{[^{}]*\\})?[^{}]*\\}|/\\s*(d|\u2202|\\\\partial|\\\\mathrm.*)\\s*t|,\\s*t\\s*\\)|\\.diff\\(\\s*t\\s*\\)|'?\\s*\\))$");
function rate_of(token) {
let inner;

inner = _END.sub("", (py_methods_endswith(token, "diff(t)") ? token : _ENVELOPE.sub("", token, { count: 1 })), { count: 1 });
return key(py_add(name_of(inner), (py_methods_startswith(token, "Symbol") ? "" : "dot")));
}

function other_names(name) {
let found, quotient;

found = [py_re.sub("omega", "w", name), py_re.sub("^(lambda\\d?)hat", "\\1", name)];
found = py_iadd(found, [py_re.sub("^(omega|w|vc|vp)([xyz])", ((f) => py_add(py_methods_replace(py_item(f, 1), "omega", "w"), py_str((py_methods_index("xyz", py_item(f, 2)) + 1)))), name)]);
if (py_t((quotient = py_re.fullmatch("d(\\w+)dt", name)))) {
py_methods_append(found, key(py_join([py_str(py_item(quotient, 1)), "dot"])));
}
return py_list((function* () { for (const each of py_iter(py_methods_fromkeys(py_dict, found))) if (!py_eq(each, name)) yield each; })());
}

const LONGEST = 9000;
const LONGEST_NUMBER = 15;
const LONGEST_WORD = 60;
const MOST_WORDS = 9000;
const DEEPEST = 40;
const FUNCTIONS = new Map([["sin", true], ["cos", true], ["tan", true], ["asin", true], ["acos", true], ["atan", true], ["sinh", true], ["cosh", true], ["tanh", true], ["sech", true], ["exp", true], ["log", true], ["sqrt", true], ["sign", true], ["abs", true], ["sgn", true], ["ln", true], ["arctan", true], ["arcsin", true], ["arccos", true], ["Abs", true], ["sec", true], ["csc", true], ["cot", true], ["coth", true]]);
const WRAPPERS = new Set(["ImmutableMatrix", "Matrix", "array", "expand", "factor", "simplify"]);
const OPENING = new Map([["LPAR", "RPAR"], ["LBRACE", "RBRACE"], ["LSQB", "RSQB"], ["_BAR_OPEN", "_BAR_CLOSE"], ["_NORM_OPEN", "_NORM_CLOSE"], ["_MATRIX", "_END_MATRIX"], ["_CASES", "_END_CASES"]]);
const _AROUND = new Map([["_MATRIX", "_END_MATRIX"], ["_CASES", "_END_CASES"], ["LBRACE", "RBRACE"]]);
const _CONTINUES = new Set(["COMMA", "EQUAL", "LBRACE", "LPAR", "LSQB", "MINUS", "PLUS", "RELATION", "SLASH", "_POWER", "_TIMES"]);
const _GOES_ON = new Set(["EQUAL", "MINUS", "PLUS", "RBRACE", "RELATION", "RPAR", "RSQB", "SLASH", "_POWER", "_TIMES"]);
const _OPERAND_ENDS = new Set(["NAME", "NUMBER", "PI", "RAISED", "RBRACE", "RPAR", "RSQB", "_BAR_CLOSE", "_END_MATRIX", "_NORM_CLOSE"]);
const _OPERAND_STARTS = new Set(["EULER", "LBRACE", "LPAR", "LSQB", "NAME", "NUMBER", "PI", "RAISED", "SLASH", "_FRACTION", "_ROOT"]);
const _N = "NAME:(\\w+)";
const _MANY = "NAME:(\\w+)(?: (?:_ROW|COMMA|_LINE|_CELL) NAME:(\\w+))*";
const _LABEL = py_pattern("(D_DT )?(NAME:(\\w+)( _POWER (LBRACE )?NAME:T( RBRACE)?)?|NAME:J LPAR NAME:(\\w+) RPAR|(LSQB |LPAR )?_MATRIX NAME:(\\w+)(?: (?:_ROW|COMMA|_LINE|_CELL) NAME:(\\w+))* _END_MATRIX( RSQB| RPAR)?|(LSQB|LPAR) NAME:(\\w+)(?: (?:_ROW|COMMA|_LINE|_CELL) NAME:(\\w+))* (RSQB|RPAR)( _POWER (LBRACE )?NAME:T( RBRACE)?)?|LSQB LSQB NAME:(\\w+) RSQB( COMMA LSQB NAME:(\\w+) RSQB)* RSQB) EQUAL");
class Words {
 constructor(text, letters, labels, functions) {
const self = this;
[self.text, self.letters, self.labels, self.functions] = py_list([text, letters, py_set_(labels), functions]);
self.known = new Set([...py_iter(letters), ...py_iter(self.labels)]);
if (py_compare(py_len(text), ">", LONGEST)) {
throw new CannotRead(text, LONGEST, py_join(["the formula has ", py_str(py_len(text)), " characters; at most ", py_str(LONGEST)]));
}
[self.plain, self.origin] = py_list(spelled(text));
}
 refuse(message, at = null) {
let position, start;
const self = this;

start = (py_isinstance(at, Token) ? at.start_pos : (py_hasattr(at, "meta") ? at.meta.start_pos : at));
position = ((!py_is(start, null) && py_compare(start, "<", py_len(self.origin))) ? py_item(self.origin, start) : py_len(self.text));
throw new CannotRead(self.text, position, message);
}
 tokens(strict = true) {
let each, found, lines, passes;
const self = this;

found = self._raw();
passes = [py_bound(self, "_sums"), py_bound(self, "_names"), py_bound(self, "_numbers"), py_bound(self, "_environments"), py_bound(self, "_times"), py_bound(self, "_joined")];
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
kinds = py_list((function* () { for (const token of py_iter(tokens)) yield token.type; })());
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
 _raw() {
let long, position, raw;
const self = this;
try {
raw = [...py_iter(lexed(laid_out(self.plain))), new Token("END", "", py_len(self.plain), { end_pos: py_len(self.plain) })];
} catch (error_) {
if (!(error_ instanceof UnexpectedCharacters)) throw error_;
let error = error_;position = py_item(self.origin, py_some(error.pos_in_stream, () => 0));
throw new CannotRead(self.text, position, about_character(py_item(self.text, position)));
}
long = py_next((function* () { for (const token of py_iter(raw)) if ((py_in(token.type, ["NAME", "RATE"]) && py_compare(py_len(token), ">", py_mul(4, LONGEST_WORD)))) yield token; })(), null);
if (py_t(long)) {
self.refuse(py_join(["a word has more than ", py_str(LONGEST_WORD), " letters; write * between letters"]), long);
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
while ((py_t(depth) || !py_in(py_item(tokens, end).type, _SUMMAND_ENDS) || py_eq(end, (start + 1)))) {
depth = py_iadd(depth, py_sub(py_in(py_item(tokens, end).type, OPENING), py_in(py_item(tokens, end).type, CLOSING)));
if ((py_compare(depth, "<", 0) || py_eq(py_item(tokens, end).type, "END"))) {
break;
}
end = py_iadd(end, 1);
}
[summand, at] = py_list([py_item(tokens, py_slice((start + 1), end, null)), py_item(tokens, start)]);
terms = py_list((function* () { for (const k of py_iter(py_range(py_int(first), (py_int(last) + 1)))) yield py_list((function* () { for (const t of py_iter(summand)) yield _indexed(t, index, py_str(k)); })()); })());
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
 _names(tokens) {
let bare, k, kinds, out, token;
const self = this;

out = [];
kinds = py_list((function* () { for (const token of py_iter(tokens)) yield token.type; })());
for ([k, token] of py_iter(py_enumerate(tokens))) {
if (py_eq(token.type, "RATE")) {
token = token.update({ type: "NAME", value: rate_of(token) });
} else {
if (py_eq(token.type, "NAME")) {
token = token.update({ value: name_of(token) });
bare = py_item(kinds, py_slice(py_max((k - 3), 0), k, null));
if ((py_eq(py_item(bare, py_slice(-1, null, null)), ["D_DT"]) || py_eq(bare, ["LPAR", "D_DT", "RPAR"]))) {
py_del(out, py_slice((py_eq(py_item(bare, py_slice(-1, null, null)), ["D_DT"]) ? -1 : -3), null, null));
token = token.update({ value: key(py_join([py_str(token), "dot"])) });
} else {
if ((py_eq(py_item(bare, py_slice(-2, null, null)), ["D_DT", "LPAR"]) && py_in("RPAR", [py_item(kinds, (k + 1)), py_item(kinds, py_slice((k + 4), (k + 5), null))]))) {
py_del(out, -2);
token = token.update({ value: key(py_join([py_str(token), "dot"])) });
}
}
}
}
py_methods_append(out, token);
}
return out;
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
self.refuse(py_join(["brackets are nested more than ", py_str(DEEPEST), " deep; write the formula flatter"]), token);
}
if ((py_in(token.type, ["NUMBER", "DECIMAL"]) && py_compare(py_len(token), ">", LONGEST_NUMBER))) {
self.refuse(py_join(["numbers have at most ", py_str(LONGEST_NUMBER), " digits"]), token);
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
told = [py_join([py_str(mantissa), " times ten to the power of ", py_str(exponent)]), py_join([py_str(mantissa), " times ", py_str(py_item(token, py_slice(e.start(), null, null)))])];
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
if ((py_eq(py_len(part), 3) && !py_eq(whole, "0") && !py_in("{", token))) {
self.refuse(two_meanings([py_add(whole, part), py_join([py_str(whole), ".", py_str(part)])], "type it without a comma"), token);
}
return [token.update({ type: "NUMBER", value: py_join([py_str(whole), ".", py_str(part)]) })];
}
 _environments(tokens) {
let begun, inside, k, opened, out, systems, token;
const self = this;

systems = _systems(tokens);
out = [];
opened = [];
for ([k, token] of py_iter(py_enumerate(tokens))) {
if (py_in(token.type, _AROUND)) {
py_methods_append(opened, k);
}
inside = py_any((function* () { for (const each of py_iter(py_item(opened, py_slice(-1, null, null)))) if (!py_in(each, systems)) yield !py_eq(py_item(tokens, each).type, "LBRACE"); })());
begun = ((py_t(opened) && py_in(token.type, py_methods_values(_AROUND))) ? py_methods_pop(opened) : k);
if (py_in(begun, systems)) {
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
 _times(tokens) {
let braced, bracket, k, kinds, name, out, size, timed;
const self = this;

out = [];
timed = py_set_();
k = 0;
while (py_compare(k, "<", py_len(tokens))) {
braced = py_eq(py_item(tokens, k).type, "LBRACE");
kinds = py_list((function* () { for (const t of py_iter(py_item(tokens, py_slice(py_add(k, braced), (py_add(k, braced) + 3), null)))) yield t.type; })());
if ((py_eq(kinds, ["LPAR", "NAME", "RPAR"]) && py_eq(py_item(tokens, (py_add(k, braced) + 1)), "t") && py_t(self._takes_time(out, py_item(tokens, k))))) {
size = py_add(3, py_mul(2, braced));
if ((py_in("t", self.letters) && (py_compare(py_add(k, size), ">=", py_len(tokens)) || !py_eq(py_item(tokens, py_add(k, size)).type, "EQUAL")))) {
name = py_item(out, -1);
self.refuse(two_meanings([py_join([py_str(name), " at the time t"]), py_join([py_str(name), " times t"])], "write * or a blank between"), py_item(tokens, k));
}
py_methods_add(timed, (py_len(out) - 1));
k = py_iadd(k, size);
continue;
}
if ((py_eq(py_item(tokens, k).type, "RPAR") && py_in((py_len(out) - 1), timed) && py_compare(py_len(out), ">", 2) && py_eq(py_item(out, -2).type, "LPAR"))) {
bracket = py_item(out, -2);
if (py_t(self._takes_time(py_item(out, py_slice(null, -2, null)), bracket))) {
py_del(out, py_slice(-2, null, null));
k = py_iadd(k, 1);
continue;
}
}
py_methods_append(out, py_item(tokens, k));
k = py_iadd(k, 1);
}
return out;
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
return py_some(py_eq(last.type, "RAISED"), () => py_every(py_eq(last.type, "NUMBER"), () => exponent), () => (py_eq(last.type, "RBRACE") && py_in("_POWER", py_list((function* () { for (const t of py_iter(py_item(before, py_slice(-5, null, null)))) yield t.type; })()))));
}
 _lines(tokens) {
let at, end, label, line, out;
const self = this;

out = [];
for ([line, end] of py_iter(self._unwrapped(_split(tokens)))) {
line = self._without_remark(line);
label = self._label(line);
if (py_t(label)) {
at = py_next((function* () { for (const [k, token] of py_iter(py_enumerate(line))) if (py_eq(token.type, "EQUAL")) yield k; })());
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
bullets = py_sum((function* () { for (const k of py_iter(py_range(py_len(tokens)))) yield _bullet(tokens, k); })());
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
if ((!(py_t(opened)) && py_t(_bullet(tokens, k)))) {
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
goes_on = (!py_eq(py_item(opened, -1), "LSQB") || py_in(before, _CONTINUES) || py_in(after.type, py_or(_GOES_ON, new Set([py_key("COMMA")]))));
goes_on = py_every(goes_on, () => !((py_in("quad", token) && py_eq(py_item(opened, -1), "LSQB") && !py_in(before, _CONTINUES))));
} else {
if (py_t(_bullet(tokens, py_item(following, k)))) {
goes_on = false;
} else {
goes_on = (py_in(before, py_sub(_CONTINUES, new Set([py_key("COMMA")]))) || (py_in(after.type, _GOES_ON) && !py_in(before, ["_LINE", "COMMA"])));
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
called = py_in(py_list((function* () { for (const t of py_iter(py_item(line, py_slice(start, (start + 2), null)))) yield py_str(t); })()), [["Eq", "("], ["Equality", "("]]);
comma = (py_t(called) ? _top_level(line, (start + 2), "COMMA") : null);
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
said = py_every(words, () => py_eq(py_item(line, (k - 1)).type, "LPAR"), () => py_compare(k, ">", 1), () => py_all((function* () { for (const t of py_iter(words)) yield (py_methods_isalpha(t) && py_compare(py_len(t), ">", 2)); })()));
return ((py_t(said) && !(py_any((function* () { for (const t of py_iter(words)) yield py_some(py_in(self._spelled(t), self.known), () => self._ways(t)); })()))) ? py_item(line, py_slice(null, (k - 1), null)) : line);
}
 _label(line) {
let end, kinds, match, name, names, rate, text, there, told, vector;
const self = this;

end = py_next((function* () { for (const [k, token] of py_iter(py_enumerate(py_item(line, py_slice(null, 200, null))))) if (py_eq(token.type, "EQUAL")) yield k; })(), null);
if ((py_is(end, null) || !py_in(py_item(line, 0).type, ["D_DT", "NAME", "LPAR", "LSQB", "_MATRIX"]))) {
return null;
}
kinds = py_list((function* () { for (const t of py_iter(py_item(line, py_slice(null, (end + 1), null)))) if (!py_in(t, WRAPPERS)) yield (py_eq(t.type, "NAME") ? py_join(["NAME:", py_str(t)]) : t.type); })());
text = py_methods_join(" ", kinds);
if ((py_eq(py_item(kinds, 0), "LPAR") && py_eq(py_item(kinds, -2), "RPAR") && (!py_in("COMMA", kinds) || py_eq(py_item(kinds, 1), "LSQB")))) {
text = py_methods_join(" ", [...py_iter(py_item(kinds, py_slice(1, -2, null))), "EQUAL"]);
}
match = _LABEL.fullmatch(text);
if (!(py_t(match))) {
return null;
}
vector = py_any((function* () { for (const kind of py_iter(["_MATRIX", "LSQB", "COMMA"])) yield py_in(kind, kinds); })());
names = (py_methods_startswith(text, "NAME:J LPAR") ? ["J"] : py_re.findall(_N, text));
if (py_in("_POWER", kinds)) {
names = (py_t(vector) ? py_item(names, py_slice(null, -1, null)) : [py_methods_join("", names)]);
}
names = py_list((function* () { for (const name of py_iter(names)) yield self._spelled((py_eq(py_item(kinds, 0), "D_DT") ? key(py_join([py_str(name), "dot"])) : name)); })());
name = py_methods_join(",", names);
if ((py_t(vector) && !py_in("_MATRIX", kinds) && py_all((function* () { for (const part of py_iter(names)) yield py_in(part, self.letters); })()))) {
return null;
}
if (!(py_all((function* () { for (const part of py_iter(names)) yield py_in(part, self.known); })()))) {
rate = py_re.fullmatch("[dD](\\w+)", name);
if ((py_t(rate) && py_in(key(py_join([py_str(py_item(rate, 1)), "dot"])), self.labels))) {
told = [py_join(["the rate of ", py_str(py_item(rate, 1))]), "a letter of your own"];
self.refuse(two_meanings(told, py_join(["for the rate write ", py_str(py_item(rate, 1)), "' ="])), py_item(line, 0));
}
if ((py_any((function* () { for (const accent of py_iter(["dot", "hat", ","])) yield py_in(accent, name); })()) || py_in(name, FUNCTIONS))) {
there = py_methods_join(", ", py_sorted(self.labels));
self.refuse(py_join(["there is no line \"", py_str(name), "\"; there are ", py_str(there)]), py_item(line, 0));
}
py_methods_add(self.known, name);
}
return py_item(line, 0).update({ type: "LABEL", value: name });
}
 _spelled(name) {
const self = this;

return py_next((function* () { for (const each of py_iter([name, ...py_iter(other_names(name))])) if (py_in(each, self.known)) yield each; })(), name);
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
let guess, kinds, known, name, near, start, transpose, typed, ways;
const self = this;
name = py_str(token);
if (py_eq(token.type, "COMMAND")) {
name = py_re.sub("\\\\(operatorname|mathrm|textrm|text|rm)(?![A-Za-z])|\\W", "", name);
if ((!py_in(name, FUNCTIONS) && !py_in(name, self.known) && !((py_eq(name, "e") && py_eq(after, "_POWER"))))) {
self.refuse(about_command(name), token);
}
token = token.update({ type: "NAME", value: name });
}
transpose = (py_eq(name, "T") && py_in(before, ["_POWER", "LBRACE"]));
if ((!py_eq(token.type, "NAME") || py_t(transpose))) {
return [token];
}
if ((py_in(name, WRAPPERS) && py_eq(after, "LPAR") && !py_in(name, self.known))) {
return [];
}
name = self._spelled(name);
if (py_in(name, self.known)) {
return [token.update({ value: name })];
}
kinds = py_or(py_or(new Map([[py_key("pi"), "PI"]]), py_methods_fromkeys(py_dict, FUNCTIONS, "FUNCTION")), py_methods_fromkeys(py_dict, self.functions, "USER_FUNCTION"));
kinds = py_or(kinds, (py_eq(after, "_POWER") ? new Map([[py_key("e"), "EULER"]]) : new Map([])));
kinds = (py_eq(after, "LPAR") ? py_or(new Map([[py_key("norm"), "FUNCTION"]]), kinds) : kinds);
if (py_in(name, kinds)) {
return [token.update({ type: py_item(kinds, name), value: name })];
}
if (py_compare(py_len(name), ">", LONGEST_WORD)) {
self.refuse(py_join(["a word has more than ", py_str(LONGEST_WORD), " letters; write * between letters"]), token);
}
ways = self._ways(name);
if (py_eq(py_len(ways), 1)) {
return py_list((function* () { for (const part of py_iter(py_item(ways, 0))) yield token.update({ value: self._spelled(key(part)) }); })());
}
if (py_t(ways)) {
self.refuse(py_join(["\"", py_str(name), "\" can be read as ", py_str(py_methods_join(" or ", py_map(" ".join, ways))), "; write * between"]), token);
}
near = py_difflib.get_close_matches(name, self.letters, 1, 0.5);
known = py_methods_join(", ", py_item(py_sorted((function* () { for (const letter of py_iter(py_methods_values(self.letters))) if (py_t(letter.is_Symbol)) yield py_str(letter); })()), py_slice(null, 40, null)));
guess = (py_t(near) ? py_join([", did you mean \"", py_str(py_item(self.letters, py_item(near, 0))), "\"? There are"]) : "; there are");
start = py_some(token.start_pos, () => 0);
typed = py_item(self.text, py_slice(py_item(self.origin, start), (py_item(self.origin, (py_some(token.end_pos, () => (start + 1)) - 1)) + 1), null));
self.refuse(py_join(["\"", py_str(py_item(typed, py_slice(null, 40, null))), "\" is no letter here", py_str(guess), " ", py_str(known)]), token);
}
 _ways(name) {
let end, start, ways;
const self = this;

ways = [[[]], ...py_iter((function* () { for (const _ of py_iter(name)) yield []; })())];
for (end of py_iter(py_range(1, (py_len(name) + 1)))) {
for (start of py_iter(py_range(end))) {
if ((py_t(py_item(ways, start)) && py_in(self._spelled(key(py_item(name, py_slice(start, end, null)))), self.letters))) {
py_put(ways, end, py_iadd(py_item(ways, end), py_list((function* () { for (const way of py_iter(py_item(ways, start))) yield [...py_iter(way), py_item(name, py_slice(start, end, null))]; })())));
}
}
py_put(ways, end, py_item(py_item(ways, end), py_slice(null, 2, null)));
}
return py_item(ways, -1);
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
py_methods_append(out, token.update({ type: py_join([py_str(kind), "_", py_str((py_t(closes) ? "CLOSE" : "OPEN"))]) }));
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

partner = _partners(tokens);
opens = py_set_();
closes = py_set_();
for ([k, token] of py_iter(py_enumerate(tokens))) {
if (!py_eq(token.type, "FUNCTION")) {
continue;
}
start = _exponent_end(tokens, partner, (k + 1));
inverse = py_list((function* () { for (const t of py_iter(py_item(tokens, py_slice((k + 1), start, null)))) if (!py_in(t.type, ["_POWER", "LBRACE", "RBRACE"])) yield py_str(t); })());
if ((py_eq(inverse, ["-", "1"]) && !py_eq(py_item(tokens, start).type, "END"))) {
self.refuse(two_meanings([py_join(["1/", py_str(token)]), py_join(["arc", py_str(token)])], py_join(["write 1/", py_str(token), "(...) or arc", py_str(token), "(...)"])), token);
}
end = _unit_end(tokens, partner, start);
if (py_is(end, null)) {
continue;
}
if (py_in(py_item(tokens, end).type, _OPERAND_STARTS)) {
told = [py_join([py_str(token), " of all that follows"]), py_join([py_str(token), " times what follows"])];
self.refuse(two_meanings(told, py_join(["write brackets, ", py_str(token), "(...)"])), py_item(tokens, end));
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
const _SUMMAND_ENDS = new Set(["COMMA", "END", "EQUAL", "MINUS", "PLUS", "RBRACE", "RELATION", "RPAR", "RSQB", "_BAR_CLOSE", "_CELL", "_END_CASES", "_END_MATRIX", "_LINE", "_NORM_CLOSE", "_ROW"]);
function _indexed(token, index, number) {

if (!py_eq(token.type, "NAME")) {
return token;
}
if (py_eq(token, index)) {
return token.update({ type: "NUMBER", value: number });
}
function put(found) {
return py_re.sub(py_join(["(?<![A-Za-z\\\\])", py_str(index), "(?![A-Za-z])|(?<=[ijklmn])", py_str(index), "|", py_str(index), "(?=[ijklmn])"]), number, py_item(found, 0));
}

return token.update({ value: py_re.sub("_\\s*(\\{[^{}]*\\}|[A-Za-z0-9]+)", put, token) });
}

function _systems(tokens) {
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
if ((py_t(opened) && py_eq(token.type, "EQUAL") && py_in(py_item(tokens, py_item(opened, -1)).type, _AROUND))) {
py_methods_add(found, py_item(opened, -1));
}
}
}
}
}
return py_sub(found, branches);
}

function _bullet(tokens, k) {
let apart, token;

token = py_item(tokens, k);
if ((!py_in(token.type, ["MINUS", "_TIMES"]) || (py_t(k) && !py_eq(py_item(tokens, (k - 1)).type, "_LINE")) || py_compare(py_len(tokens), "<", (k + 3)))) {
return false;
}
apart = py_compare(py_some(token.end_pos, () => 0), "<", py_some(py_item(tokens, (k + 1)).start_pos, () => 0));
return py_every(apart, () => py_eq(py_item(tokens, (k + 1)).type, "NAME"), () => py_eq(py_item(tokens, (k + 2)).type, "EQUAL"));
}

function* _split(tokens) {
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

function _top_level(line, start, kind) {
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

function _partners(tokens) {
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

function _exponent_end(tokens, partner, k) {

if (py_eq(py_item(tokens, k).type, "RAISED")) {
return (k + 1);
}
if (!py_eq(py_item(tokens, k).type, "_POWER")) {
return k;
}
k = py_iadd(k, py_add(1, py_eq(py_item(tokens, (k + 1)).type, "MINUS")));
return py_min((py_methods_get(partner, k, k) + 1), (py_len(tokens) - 1));
}

function _unit_end(tokens, partner, k) {
let _, braces, number;

number = py_eq(py_item(tokens, k).type, "NUMBER");
k = py_iadd(k, number);
braces = py_methods_get(new Map([[py_key("_FRACTION"), 2], [py_key("_ROOT"), 1]]), py_item(tokens, k).type, 0);
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
return _exponent_end(tokens, partner, k);
}

export { Words, _blank, _bullet, _delimited, _exponent_end, _indexed, _line, _outside, _partners, _plain, _said, _split, _systems, _top_level, _unit_end, _without_stop, about_character, about_command, about_token, laid_out, name_of, other_names, rate_of, spelled, two_meanings };
