/** Facts that a browser tells about its machine; null if it does not tell. */
export interface BrowserMachine {
  /** The browser, as it calls itself. */
  readonly browser: string;
  readonly platform: string | null;
  /** `arm`, `x86`. */
  readonly architecture: string | null;
  /** Of a phone or tablet. */
  readonly model: string | null;
  /** Threads that the processor runs at once. */
  readonly threads: number | null;
  /** Browsers round it, and tell no more than a certain number. */
  readonly memoryGiB: number | null;
}

/** Parts of `Navigator` that not every browser has; TypeScript knows of none of them. */
export interface TellingNavigator extends Pick<Navigator, 'userAgent' | 'hardwareConcurrency'> {
  readonly deviceMemory?: number;
  readonly userAgentData?: {
    getHighEntropyValues(hints: readonly string[]): Promise<Readonly<Record<string, unknown>>>;
  };
}

const HINTS = ['architecture', 'bitness', 'model', 'platform', 'platformVersion'];

export async function browserMachine(navigator: TellingNavigator): Promise<BrowserMachine> {
  // A page's permissions may withhold them.
  const told = await navigator.userAgentData?.getHighEntropyValues(HINTS).catch(() => undefined);
  const text = (name: string) => (typeof told?.[name] === 'string' && told[name] !== '' ? told[name] : null);
  const joined = (...names: string[]) => names.flatMap((name) => text(name) ?? []).join(' ') || null;
  return {
    browser: navigator.userAgent,
    platform: joined('platform', 'platformVersion'),
    architecture: joined('architecture', 'bitness'),
    model: text('model'),
    threads: navigator.hardwareConcurrency || null,
    memoryGiB: navigator.deviceMemory ?? null,
  };
}
