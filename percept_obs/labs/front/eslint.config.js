import js from "@eslint/js";
import globals from "globals";

const MODEL = ["src/state/**/*.js", "src/engine/**/*.js"];
const OTHERS = "^(?!\\./[^/]+$|\\.\\./(state|engine)/)";
const message = "what computes knows nothing of the page: import from state/ and engine/ only";

/** For what the tests put into pages. */
export const IN_TESTS = [
  js.configs.recommended,
  { languageOptions: { globals: { ...globals.browser, STATE_OF_THE_LAB: false } }, rules: { eqeqeq: "error", "prefer-const": "error" } },
  { files: ["**/*.mjs"], languageOptions: { globals: globals.node } },
];

export default [
  js.configs.recommended,
  {
    files: ["src/**/*.js", "article.js"],
    ignores: MODEL,
    languageOptions: { globals: globals.browser },
  },
  {
    files: MODEL,
    languageOptions: { globals: globals["shared-node-browser"] },
    rules: {
      "no-restricted-imports": ["error", { patterns: [{ regex: OTHERS, message }] }],
    },
  },
  {
    files: ["src/**/*.js"],
    rules: {
      "no-unused-vars": ["error", { varsIgnorePattern: "^_", argsIgnorePattern: "^_" }],
      eqeqeq: "error",
      "prefer-const": "error",
    },
  },
  {
    files: ["src/**/*.js"],
    ignores: ["src/draw/looks.js"], // printed by Python
    rules: { "max-len": ["error", { code: 120 }] },
  },
  { files: ["tests/**/*.js"], languageOptions: { globals: globals.node } },
];
