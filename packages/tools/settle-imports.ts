import { afterAll, vi } from 'vitest';

// Modules fetch code ahead. If a file of tests ends meanwhile, the fetch fails, and the process that the next
// files share would keep the failure.
afterAll(() => vi.dynamicImportSettled());
