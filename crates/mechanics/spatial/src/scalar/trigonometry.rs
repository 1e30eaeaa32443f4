//! Sine and cosine of a double-double angle.
//!
//! 1. The angle is reduced to r = x − n·π/2 with |r| ≤ π/4. Where x is moderate and r not tiny, Cody and Waite's method subtracts the parts
//!    of n·π/2. Otherwise the method of M. Payne and R. Hanek (1983) is used: it multiplies the digits of 2/π that matter by the integer
//!    mantissas of x. So 331 binary digits of the fraction of x·2/π are right at every magnitude. There are fewer than 2¹²⁸ double-doubles.
//!    So by counting, the nearest one comes within about 2⁻¹²⁸ of a multiple of π/2, and 200 of these digits are significant.
//! 2. With d = |r| − k/64 and |d| ≤ 1/128, sin d and cos d come from Taylor's series.
//! 3. The addition theorem combines them with tabulated sin k/64 and cos k/64.
//!
//! | step | error relative to the result, at most (u = 2⁻⁵³) |
//! |---|---|
//! | r | 9u² |
//! | what is added to the tabulated value | 14u² where that is half the result, 1u² elsewhere |
//! | the addition | 3u² |

use super::double_double::DoubleDouble;
use super::error_free::{fast_two_sum, two_product, two_sum};
use super::{Part, Real};

/// Sine and cosine; NaN of angles that are infinite or NaN.
pub(super) fn sin_cos(x: DoubleDouble) -> (DoubleDouble, DoubleDouble) {
    if !x.to_f64().is_finite() {
        let nan = DoubleDouble::from_f64(f64::NAN);
        return (nan, nan);
    }
    let (quadrant, r) = reduce(x);
    let (sin, cos) = kernel(r);
    match quadrant & 3 {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

/// Below this angle n < 2³⁰, and n·π/2 by parts has an error of n·2⁻¹⁶³.
pub(super) const MODERATE: f64 = 1.6e9;

/// If the rest is above this, the partial sums of its errors are small against it, and so are their errors.
pub(super) const NOT_TINY: f64 = 1.0 / 1048576.0;

/// The number n of quarter turns (right in its last two bits) and the rest x − n·π/2, at most about π/4.
#[inline(always)]
fn reduce(x: DoubleDouble) -> (u64, DoubleDouble) {
    let turns = (x.to_f64() * FRAC_2_PI).round_ties_even();
    if turns == 0.0 {
        return (0, x);
    }
    if x.to_f64().abs() < MODERATE {
        let (rest, errors) = subtract_quarter_turns(x, turns);
        if rest.abs() > NOT_TINY {
            return (turns as i64 as u64, DoubleDouble::renormalized(rest, errors));
        }
    }
    reduce_by_digits(x)
}

/// `x − turns·π/2` by the parts of π/2, as a sum and its errors. `turns` is the whole number nearest to x·2/π.
#[inline(always)]
pub(super) fn subtract_quarter_turns<T: Part>(x: DoubleDouble<T>, turns: T) -> (T, T) {
    let [high, middle, low] = FRAC_PI_2.map(T::from_f64);
    let ((first, first_error), (second, second_error)) = (two_product(turns, high), two_product(turns, middle));
    // exact, because the two differ by less than a factor of two
    let rest = x.hi() - first;
    let (rest, e1) = two_sum(rest, -first_error);
    let (rest, e2) = two_sum(rest, x.rest());
    let (rest, e3) = two_sum(rest, -second);
    (rest, (e1 + e2) + (e3 - second_error) - turns * low)
}

/// [`reduce`] at any magnitude, and however near to a multiple of π/2.
#[cold]
#[inline(never)]
fn reduce_by_digits(x: DoubleDouble) -> (u64, DoubleDouble) {
    let mut turns = quarter_turns(x.to_f64());
    add(&mut turns, &quarter_turns(x.rest()));

    // Round to the nearest whole number: the fraction becomes a signed one.
    let negative = turns[1] >> 63 == 1;
    let whole = if negative { turns[0].wrapping_add(1) } else { turns[0] };
    if negative {
        negate(&mut turns);
    }
    let fraction = &turns[1..];

    // Its first 159 significant bits, as three f64.
    let zeros = fraction.iter().position(|&word| word != 0).map_or(0, |k| 64 * k as i64 + i64::from(fraction[k].leading_zeros()));
    let [a, b, c] = [53, 106, 159].map(|end| (bits(fraction, zeros + end - 53) >> 11) as f64 * power_of_two(-(zeros + end)));
    let fraction = DoubleDouble::renormalized(a, b + c);
    let rest = fraction * DoubleDouble::from_parts(FRAC_PI_2[0], FRAC_PI_2[1]);
    (whole, if negative { -rest } else { rest })
}

/// Whole words and six words of fraction.
type Turns = [u64; 7];

/// `value · 2/π` modulo 2⁶⁴ in fixed point, two's complement, most significant word first; its last 53 bits are not right.
fn quarter_turns(value: f64) -> Turns {
    let biased = (value.to_bits() >> 52 & 0x7ff) as i64;
    let fraction = value.to_bits() & ((1 << 52) - 1);
    let (mantissa, exponent) = if biased == 0 { (fraction, -1074) } else { (fraction | 1 << 52, biased - 1075) };

    let mut turns = [0; 7];
    let mut carry = 0;
    for (k, word) in turns.iter_mut().enumerate().rev() {
        // bits of 2/π · 2^exponent, without the multiples of 2⁶⁴
        let product = u128::from(bits(&DIGITS_2_PI, exponent - 64 + 64 * k as i64)) * u128::from(mantissa) + carry;
        *word = product as u64;
        carry = product >> 64;
    }
    if value.is_sign_negative() {
        negate(&mut turns);
    }
    turns
}

/// The 64 bits from bit `at` of a row of words, zeros outside.
fn bits(words: &[u64], at: i64) -> u64 {
    let word = |k: i64| usize::try_from(k).ok().and_then(|k| words.get(k).copied()).unwrap_or(0);
    let (k, shift) = (at.div_euclid(64), at.rem_euclid(64));
    if shift == 0 { word(k) } else { word(k) << shift | word(k + 1) >> (64 - shift) }
}

fn add(a: &mut Turns, b: &Turns) {
    let mut carry = 0;
    for (a, b) in a.iter_mut().zip(b).rev() {
        let sum = u128::from(*a) + u128::from(*b) + carry;
        *a = sum as u64;
        carry = sum >> 64;
    }
}

fn negate(a: &mut Turns) {
    for word in a.iter_mut() {
        *word = !*word;
    }
    add(a, &[0, 0, 0, 0, 0, 0, 1]);
}

/// 2ⁿ for a normal result.
fn power_of_two(n: i64) -> f64 {
    f64::from_bits(((1023 + n) as u64) << 52)
}

/// Sine and cosine of an angle of at most about π/4.
#[inline(always)]
fn kernel(r: DoubleDouble) -> (DoubleDouble, DoubleDouble) {
    let negative = r.to_f64() < 0.0;
    let r = if negative { -r } else { r };
    let k = (r.to_f64() * 64.0).round_ties_even();
    let (sin, cos) = near_tabulated(r, k, SIN_COS_OF_64THS[k as usize]);
    (if negative { -sin } else { sin }, cos)
}

/// Sine and cosine of an angle near k/64; `tabulated` has those of k/64, each in two parts.
#[inline(always)]
pub(super) fn near_tabulated<T: Part>(r: DoubleDouble<T>, k: T, tabulated: [T; 4]) -> (DoubleDouble<T>, DoubleDouble<T>) {
    let [sin_hi, sin_lo, cos_hi, cos_lo] = tabulated;
    let (s, c) = (DoubleDouble::from_parts(sin_hi, sin_lo), DoubleDouble::from_parts(cos_hi, cos_lo));
    let constants = |high: f64, rest: f64| DoubleDouble::from_parts(T::from_f64(high), T::from_f64(rest));
    let horner = |y: T, inner: T, outer: f64| y.mul_add(inner, T::from_f64(outer));

    // d = r − k/64, the first difference exact;  z = d² ≤ 2⁻¹⁴
    let (d_hi, d_lo) = fast_two_sum(r.hi() - k * T::from_f64(1.0 / 64.0), r.rest());
    let d = DoubleDouble::from_parts(d_hi, d_lo);
    let z = d.times(d);
    let y = z.hi();

    // sin d = d + d z (−1/3! + z (1/5! + z (−1/7! + …))), the inner terms in one part: they add less than 2⁻⁵⁴ of the sum
    let tail = horner(y, horner(y, horner(y, T::from_f64(SIN[5]), SIN[4]), SIN[3]), SIN[2]);
    let fifth = DoubleDouble::renormalized(T::from_f64(SIN[1]), horner(y, tail, SIN_REST[1]));
    let third = descending(constants(SIN[0], SIN_REST[0]), z.times(fifth));
    let sin_d = descending(d, d.times(z.times(third)));

    // cos d − 1 = z (−1/2! + z (1/4! + z (−1/6! + …)))
    let tail = horner(y, horner(y, horner(y, T::from_f64(COS[6]), COS[5]), COS[4]), COS[3]);
    let sixth = DoubleDouble::renormalized(T::from_f64(COS[2]), horner(y, tail, COS_REST[2]));
    let fourth = descending(constants(COS[1], COS_REST[1]), z.times(sixth));
    let cos_d_less_one = z.times(descending(constants(COS[0], 0.0), z.times(fourth)));

    // sin(k/64 + d) = s + (c sin d + s (cos d − 1)),  cos(k/64 + d) = c + (c (cos d − 1) − s sin d)
    let sin = s.plus(c.times_plus(sin_d, s.times(cos_d_less_one)));
    let cos = descending(c, c.times_plus(cos_d_less_one, -s.times(sin_d)));
    (sin, cos)
}

/// `a + b` where |b| is less than a hundredth of |a|, so that nothing cancels: relative error at most 3u².
#[inline(always)]
fn descending<T: Part>(a: DoubleDouble<T>, b: DoubleDouble<T>) -> DoubleDouble<T> {
    let (sum, error) = fast_two_sum(a.hi(), b.hi());
    DoubleDouble::renormalized(sum, error + (a.rest() + b.rest()))
}

/// π/2 in three parts.
const FRAC_PI_2: [f64; 3] = [std::f64::consts::FRAC_PI_2, 6.123233995736766e-17, -1.4973849048591698e-33];

pub(super) const FRAC_2_PI: f64 = std::f64::consts::FRAC_2_PI;

/// (−1)ᵏ/(2k + 3)!, then the rounding errors of the first two.
const SIN: [f64; 6] = [
    -0.16666666666666666,
    0.008333333333333333,
    -0.0001984126984126984,
    2.7557319223985893e-06,
    -2.505210838544172e-08,
    1.6059043836821613e-10,
];
const SIN_REST: [f64; 2] = [-9.25185853854297e-18, 1.1564823173178714e-19];

/// (−1)ᵏ/(2k + 2)!, then the rounding errors of the first three.
const COS: [f64; 7] = [
    -0.5,
    0.041666666666666664,
    -0.001388888888888889,
    2.48015873015873e-05,
    -2.755731922398589e-07,
    2.08767569878681e-09,
    -1.1470745597729725e-11,
];
const COS_REST: [f64; 3] = [0.0, 2.3129646346357427e-18, 5.300543954373577e-20];

/// The first 1408 binary digits of 2/π after the point.
#[rustfmt::skip] // a table
const DIGITS_2_PI: [u64; 22] = [
    0xa2f9_836e_4e44_1529, 0xfc27_57d1_f534_ddc0, 0xdb62_9599_3c43_9041, 0xfe51_63ab_debb_c561,
    0xb724_6e3a_424d_d2e0, 0x0649_2eea_09d1_921c, 0xfe1d_eb1c_b129_a73e, 0xe882_35f5_2ebb_4484,
    0xe99c_7026_b45f_7e41, 0x3991_d639_8353_39f4, 0x9c84_5f8b_bdf9_283b, 0x1ff8_97ff_de05_980f,
    0xef2f_118b_5a0a_6d1f, 0x6d36_7ecf_27cb_09b7, 0x4f46_3f66_9e5f_ea2d, 0x7527_bac7_ebe5_f17b,
    0x3d07_39f7_8a52_92ea, 0x6bfb_5fb1_1f8d_5d08, 0x5603_3046_fc7b_6bab, 0xf0cf_bc20_9af4_361d,
    0xa9e3_9161_5ee6_1b08, 0x6599_855f_14a0_6840,
];

/// Sine and cosine of k/64, each in two parts.
#[rustfmt::skip] // a table
pub(super) const SIN_COS_OF_64THS: [[f64; 4]; 52] = [
    [0.0, 0.0, 1.0, 0.0],
    [0.015624364224883372, -1.2650937552759816e-19, 0.9998779321710066, 3.216122229972341e-17],
    [0.03124491398532608, -1.562781562225433e-18, 0.9995117584851364, -3.418806487972947e-17],
    [0.04685783574813424, -2.3419368365610254e-18, 0.9989015683384429, -2.1425557800399754e-17],
    [0.0624593178423802, -2.040259504585711e-18, 0.9980475107000991, 3.3232291674141346e-17],
    [0.07804555138996731, -5.449443782005793e-18, 0.9969497940760287, -1.2467075728553626e-17],
    [0.09361273123551289, 1.4628632005878733e-18, 0.9956086864580017, 3.312922430932991e-17],
    [0.10915705687532236, 6.6284699502736666e-18, 0.9940245152582091, 1.3287985046260087e-17],
    [0.12467473338522769, -2.925947496057858e-18, 0.992197667229329, 4.754870575189364e-17],
    [0.1401619723470637, -9.946847113883478e-18, 0.9901285883701071, -4.589906353553811e-18],
    [0.15561499277355603, 8.886053372342288e-18, 0.9878177838164719, 4.91917302237681e-17],
    [0.17103002203139503, -9.954774726452923e-18, 0.9852658177182139, -4.925721262944555e-17],
    [0.18640329676226988, 2.3493796901281573e-18, 0.9824733131012553, -3.919920375420088e-17],
    [0.2017310638016388, 5.587232815460113e-18, 0.9794409517155483, 1.3108769521526758e-17],
    [0.21700958109501015, 1.1170071073364376e-17, 0.9761694738686353, -7.850690609285027e-18],
    [0.23223511861151147, -8.318080852687206e-18, 0.9726596782449127, 2.3920264546490165e-17],
    [0.24740395925452294, -7.53102495590706e-18, 0.9689124217106447, 5.071436662403936e-17],
    [0.2625123997691533, -2.2534597527902125e-17, 0.964928619104771, -3.0345542681018625e-18],
    [0.2775567516463363, 1.7674070262791822e-17, 0.9607092430155619, -2.807827063516729e-17],
    [0.29253334202332754, 7.516944930327352e-18, 0.9562553235431753, -3.148450868841629e-17],
    [0.30743851458038085, 1.1004366442765296e-19, 0.9515679480481722, -3.8614834675674123e-17],
    [0.3222686304333866, 2.093773358126606e-17, 0.9466482608860534, -3.911683334934152e-17],
    [0.33702006902225307, 1.0312279860787216e-17, 0.9414974631278811, -4.8523830236797095e-18],
    [0.3516892289948141, -2.5616208736069942e-17, 0.9361168122670553, -5.2350302039683216e-17],
    [0.36627252908604757, -9.938814562106524e-18, 0.9305076219123143, 4.488760003328074e-18],
    [0.38076640899239017, 2.1372528646211374e-17, 0.924671261467036, 5.5444125388034563e-17],
    [0.39516733024093426, -1.9613487871414228e-17, 0.9186091557949183, -4.0564150104514996e-17],
    [0.40947177705329507, -5.679403000091266e-18, 0.9123227848721178, 2.6349040211413332e-17],
    [0.42367625720393803, -2.331800700068871e-17, 0.9058136834259364, 4.2864666490805214e-17],
    [0.4377773028727551, 7.64345629962023e-18, 0.8990834405601384, 9.076951775075616e-18],
    [0.4517714714916838, -8.234073942098903e-18, 0.8921336993669944, 2.3160655211380166e-17],
    [0.46565534658516017, 1.459870391051426e-17, 0.8849661565261433, -7.690557775987357e-18],
    [0.479425538604203, -5.103969860556013e-18, 0.8775825618903728, -4.2623149864279997e-17],
    [0.49307868575392305, 5.605083973871755e-18, 0.8699847180584174, 1.657385110740923e-17],
    [0.5066114548142574, -3.269413423618168e-17, 0.8621744799348805, 4.4132427578105805e-18],
    [0.520020541953727, -3.983266745698455e-17, 0.8541537542773854, 5.420565102675286e-18],
    [0.5333026735360201, 5.129318115032044e-17, 0.8459244992310679, 1.549506647350329e-17],
    [0.5464546069192036, 8.399754840929507e-18, 0.8374887238505236, 4.3337026043948396e-17],
    [0.5594731312473669, 1.575565514488728e-17, 0.8288484876093257, 1.1163935406617444e-17],
    [0.5723550682345072, 2.6575872357215316e-17, 0.820005899897234, -3.912431748209128e-17],
    [0.5850972729404622, -5.4883972461161805e-17, 0.8109631195052179, -3.091333486122179e-17],
    [0.5976966345387015, 5.450323593054385e-17, 0.8017223540984184, 4.0134533311087014e-17],
    [0.6101500770757914, -1.479826990758988e-17, 0.7922858596771786, -2.9049779312834576e-17],
    [0.6224545602223437, -6.049035765709707e-18, 0.7826559400262728, -1.474071641211487e-17],
    [0.6346070800152693, -3.4568582392624965e-17, 0.7728349461524715, 4.231014921891023e-17],
    [0.6466046695911524, 4.567647714393289e-19, 0.7628252757105762, 1.6672995021546628e-17],
    [0.6584443999105676, -3.7736386700306717e-17, 0.7526293724180665, -1.2970993013150526e-17],
    [0.6701233804731629, 6.183536725574959e-18, 0.7422497254585013, -1.2339303604869521e-17],
    [0.6816387600233341, 4.410467313197903e-17, 0.7316888688738209, -1.0475824306512768e-17],
    [0.692987727246318, -5.3543290798909455e-17, 0.7209493809456964, 3.494986701478816e-17],
    [0.7041675114545337, -3.94095700584825e-17, 0.7100338835660797, 1.505272211891291e-17],
    [0.7151753832640076, -1.466099578328228e-17, 0.6989450415971057, -5.5261332036460915e-18],
];
