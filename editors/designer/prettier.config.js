// How the page's source is laid out.
export default { printWidth: 120, objectWrap: "collapse" };
