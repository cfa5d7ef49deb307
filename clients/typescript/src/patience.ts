// Patience with a service that is busy or out of reach: how long to pause before the next attempt, and when to give up.

/** Between two attempts: also where something between us and the service says less, and however often it fails. */
const LEAST_PAUSE_S = 1;
const LONGEST_PAUSE_S = 20;
/** Longer than the service waits for a job, or is silent in a stream. */
const MOST_SILENCE_S = 60;

/** Time as it is measured and waited for, in seconds. */
export const clock = {
  now: (): number => Date.now() / 1000,
  most_silence_s: MOST_SILENCE_S,
  sleep: (seconds: number): Promise<void> => new Promise((resolve) => setTimeout(resolve, seconds * 1000)),
};

/** Attempts until the service answers. */
export class Patience {
  private since: number | undefined;
  private next_s = LEAST_PAUSE_S;

  /** The service has answered: the next attempt that fails is the first again. */
  renew(): void {
    this.since = undefined;
    this.next_s = LEAST_PAUSE_S;
  }

  /** Waits before the next attempt, as long as told, else twice as long each time. False, at once, where that would be later than so
   * many seconds after the first that failed. */
  async pause(most_s: number, told_s?: number): Promise<boolean> {
    const pause_s = told_s === undefined ? this.next_s : Math.max(told_s, LEAST_PAUSE_S);
    this.next_s = Math.min(2 * this.next_s, LONGEST_PAUSE_S);
    const now = clock.now();
    this.since ??= now;
    if (now + pause_s > this.since + most_s) return false;
    await clock.sleep(pause_s);
    return true;
  }
}

/** What comes of the service; throws a `TypeError`, as `fetch` does, where nothing comes for a minute. */
export async function heard<T>(coming: (silent: AbortSignal) => Promise<T>): Promise<T> {
  const silence = new AbortController();
  const { signal } = silence;
  const silent = new Promise<never>((_, reject) => { signal.onabort = () => reject(signal.reason); });
  const timer = setTimeout(() => silence.abort(new TypeError(`nothing came for ${clock.most_silence_s} s`)), clock.most_silence_s * 1000);
  try {
    return await Promise.race([coming(signal), silent]);
  } finally {
    clearTimeout(timer);
  }
}
