/** A place to go to instead. */
export interface Link {
  readonly label: string;
  readonly href: string;
}

/** A failure as it is shown: a title of a few words, the particulars, and advice. */
export interface FailureReport {
  readonly title: string;
  readonly message: string;
  readonly advice: string;
  /** Whether the engine did not throw it on purpose: a mistake of ours, whose particulars belong in the console. */
  readonly isFault: boolean;
  /** Where to go instead. */
  readonly links?: readonly Link[];
}
