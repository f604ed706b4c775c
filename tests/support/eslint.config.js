// The scripts that stand in the pages of tests are read as those of the page: npm run lint in percept_obs/labs/front.
export { IN_TESTS as default } from "../../percept_obs/labs/front/eslint.config.js";
