// A field of a request by its JSON Schema: which control it wants, what its value is, how a command writes it.
// Nothing here touches the page.

/** @typedef {Messages.FormField} Field */

const typesOf = (schema) => [schema.type].flat();

/** The type of a value that is there. */
export const typeOf = (schema) => typesOf(schema).find((type) => type !== "null");

/**
 * Whether null is a value: the field may be left as it is.
 *
 * @param {Field} field
 */
export const isOptional = (field) => typesOf(field).includes("null");

/**
 * The control of a field. A value that is a line of a file has blanks of its own: one value a line.
 *
 * @param {Field} field
 * @returns {"check" | "choice" | "lines" | "text"}
 */
export function controlOf(field) {
  if (typeOf(field) === "array") return field.placeholder === "LINE" ? "lines" : "text";
  if (field.enum) return "choice";
  if (typeOf(field) !== "boolean") return "text";
  return isOptional(field) ? "choice" : "check";
}

/**
 * The choices of a field, each with its words; `usual` stands for null.
 *
 * @param {Field} field
 * @param {{ usual: string, yes: string, no: string }} words
 * @returns {Array<[string, string]>}
 */
export function choicesOf(field, words) {
  const known = field.enum ?? [true, false];
  const spoken = { true: words.yes, false: words.no };
  const listed = known
    .filter((value) => value !== null)
    .map((value) => [String(value), spoken[value] ?? String(value)]);
  return /** @type {any} */ (isOptional(field) ? [["", words.usual], ...listed] : listed);
}

/**
 * The default of a field as its control shows it.
 *
 * @param {Field} field
 */
export function shownDefault(field) {
  if (controlOf(field) === "check") return field.default === true;
  return [field.default ?? ""].flat().join(controlOf(field) === "lines" ? "\n" : " ");
}

/**
 * The value of a field as a message has it; a number stays the text that was typed, which Python judges.
 *
 * @param {Field} field
 * @param {string | boolean} shown
 */
export function valueOf(field, shown) {
  if (typeof shown === "boolean") return shown;
  const text = shown.trim();
  if (typeOf(field) === "array") return text.split(controlOf(field) === "lines" ? /\s*\n\s*/ : BETWEEN).filter(Boolean);
  if (typeOf(field) === "boolean") return text === "" ? null : text === "true";
  return text;
}

/** Between the words of a list: the `log` of a range belongs to it. */
const BETWEEN = /\s+(?!log(?:\s|$))/;

/** Whether a value says no more than the default. */
const saysNothing = (field, value) => [value ?? ""].flat().join(" ") === [field.default ?? ""].flat().join(" ");

/**
 * The words of a command that say what a form says.
 *
 * @param {Field[]} fields
 * @param {Record<string, any>} values
 * @returns {string[]}
 */
export function optionsOf(fields, values) {
  return fields.flatMap((field) => {
    const value = values[field.name];
    if (!field.option || value === undefined || value === null || value === "" || saysNothing(field, value)) return [];
    if (typeof value === "boolean") return value ? [field.option] : [field.option.replace("--", "--no-")];
    if (!Array.isArray(value)) return [field.option, value];
    return field.repeated ? value.flatMap((each) => [field.option, each]) : [field.option, ...value];
  });
}

/** What of a command line needs quotes gets them. */
export const quoted = (word) => (/^[\w./:=,+-]+$/.test(word) ? word : `'${word.replaceAll("'", "'\\''")}'`);
