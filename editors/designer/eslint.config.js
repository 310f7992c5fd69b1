// What the page's source is held to. The longest functions of all are those that build a pane.
import js from "@eslint/js";
import globals from "globals";

export default [
  js.configs.recommended,
  {
    languageOptions: { ecmaVersion: 2023, sourceType: "module", globals: globals.browser },
    rules: {
      eqeqeq: "error",
      "no-var": "error",
      "prefer-const": "error",
      "no-unused-vars": ["error", { argsIgnorePattern: "^_", varsIgnorePattern: "^_" }],
      "no-shadow": "off",
      "no-use-before-define": ["error", { functions: false, classes: false, variables: false }],
      "no-implicit-globals": "error",
      "no-control-regex": "off", // draw.js looks for control characters
    },
  },
  { rules: { "max-lines-per-function": ["error", 80] } },
  { files: ["editors/designer/**/*.js"], languageOptions: { globals: globals.node } },
  {
    ignores: [
      "**/node_modules/**",
      "src/fuzzyarm/apps/designer/page/vendor/**",
      "src/fuzzyarm/apps/designer/page/built/**",
    ],
  },
];
