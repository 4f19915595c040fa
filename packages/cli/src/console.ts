/** Output of a command, which tests can capture. */
export interface Console {
  /** Results. */
  out(text: string): void;
  /** One-line notes and errors. */
  err(text: string): void;
}
