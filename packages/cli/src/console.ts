/** Where a command writes; tests read it back. */
export interface Console {
  /** Results. */
  out(text: string): void;
  /** One-line notes and errors. */
  err(text: string): void;
}
