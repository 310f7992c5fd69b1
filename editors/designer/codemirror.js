export { EditorState, Compartment, StateEffect, StateField, RangeSetBuilder, Annotation, Transaction } from "@codemirror/state";
export { EditorView, Decoration, keymap, lineNumbers, highlightActiveLine, drawSelection, hoverTooltip, showTooltip } from "@codemirror/view";
export { history, historyKeymap, defaultKeymap, undo, redo, indentWithTab } from "@codemirror/commands";
export { autocompletion, completionKeymap, startCompletion, snippet } from "@codemirror/autocomplete";
export { setDiagnostics, lintGutter, lintKeymap, openLintPanel, forceLinting } from "@codemirror/lint";
export { searchKeymap, highlightSelectionMatches } from "@codemirror/search";
export { collab, sendableUpdates, receiveUpdates, getSyncedVersion, getClientID } from "@codemirror/collab";
export { ChangeSet } from "@codemirror/state";
